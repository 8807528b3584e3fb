import type { Grid } from "../report/document";
import { formatNumber } from "../report/format";
import { itemAt } from "../report/lists";
import { scrollingTable, watchTables } from "../report/tables";
import type { Marks } from "./arm_tables";
import { cursor } from "./cursor";
import { replaceContent } from "./parts";
import { ask } from "./server";

/** The answers of the server for A and for B; null: none. */
export const marks: Marks = { a: null, b: null };

/** Fills the table in its place: where only numbers differ, only they are written. */
export function fillTable(host: HTMLElement, table: Grid) {
  const lines = [...host.querySelectorAll("tbody tr")];
  const shape = JSON.stringify([table.caption, table.columns, table.rows.map(([name]) => name)]);
  if (host.dataset.shape !== shape) {
    host.dataset.shape = shape;
    replaceContent(host, scrollingTable(table));
    watchTables(host);
    return;
  }
  table.rows.forEach((row, index) =>
    row.forEach((value, at) => {
      const text = typeof value === "string" ? value : formatNumber(value, itemAt(table.columns, at).format);
      const cell = lines[index]?.children[at];
      if (cell && cell.textContent !== text) cell.textContent = text;
    }),
  );
}

/** What the arm does at one time: that sample alone. */
export async function askMark(name: "a" | "b", recording: number) {
  const time = cursor[name];
  if (time === null) {
    marks[name] = null;
    return;
  }
  const half = 1e-6 * Math.max(1, Math.abs(time));
  const answer = await ask("GET", "/arm", { query: { recording, instants: 2, from: time - half, to: time + half } });
  if (cursor[name] === time) marks[name] = answer;
}
