import type { Cell, Grid, Value } from "../report/document";
import { formatNumber } from "../report/format";
import { itemAt } from "../report/lists";
import { scrollingTable } from "../report/tables";
import type { Arm, ArmJoint } from "./api";
import { cursor } from "./cursor";
import { replaceContent } from "./parts";
import { watchTables } from "./refill";
import { ask } from "./server";

/** What the table of A and B shows of every joint: how it is called, where it is in the answer, its unit. */
export type Quantity = "position" | "measured" | "model" | "error" | "percent";

export const kQuantities: Record<Quantity, { name: string; unit: (joint: ArmJoint) => string }> = {
  position: { name: "Position", unit: ({ unit }) => unit },
  measured: { name: "Measured torque", unit: ({ torque_unit }) => torque_unit },
  model: { name: "Model torque", unit: ({ torque_unit }) => torque_unit },
  error: { name: "Error", unit: ({ torque_unit }) => torque_unit },
  percent: { name: "Error as a share of the torque", unit: () => "%" },
};

/** The answers of the server for A and for B; null: none. */
export const marks: Marks = { a: null, b: null };

interface Marks {
  a: Arm | null;
  b: Arm | null;
}

/** One unit where all joints have it, or none in the column's head. */
function commonUnit(joints: ArmJoint[], quantity: Quantity): string {
  const [first = "", ...others] = new Set(joints.map(kQuantities[quantity].unit));
  return others.length === 0 ? first : "";
}

function jointTitle(joint: ArmJoint, units: string) {
  return `${joint.joint}. ${joint.name}${units === "" ? "" : ` [${units}]`}`;
}

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

/** Of the instant that is shown: what the picture shows, in numbers. */
export function cursorTable(data: Arm, instant: number): Grid {
  const { joints } = data;
  const mixed = commonUnit(joints, "position") === "";
  const columns = [
    { name: "Joint", unit: "", format: "" },
    { name: "Position", unit: commonUnit(joints, "position"), format: ".4g" },
    { name: "Error", unit: commonUnit(joints, "error"), format: ".3g" },
    { name: "Share", unit: "%", format: ".1f" },
  ];
  if (data.over_bound !== null) columns.push({ name: "Of bound", unit: "", format: ".2f" });
  const rows = joints.map((joint, index) => {
    const row: Cell[] = [jointTitle(joint, mixed ? `${joint.unit}, ${joint.torque_unit}` : "")];
    for (const what of [data.position, data.error, data.percent]) row.push(what[index]?.[instant] ?? null);
    if (data.over_bound !== null) row.push(data.over_bound[index]?.[instant] ?? null);
    return row;
  });
  return { caption: "At the cursor; share: of the rms of the joint's torque", columns, rows };
}

/** At the cursor, at A and at B; null: there is none. */
type Row = [Value, Value, Value];

/** From A to B. */
export function difference(a: Value, b: Value): Value {
  return a === null || b === null ? null : b - a;
}

/** A, B and what lies between them, of one quantity. */
export function markTable(data: Arm, { a, b }: Marks, instant: number, quantity: Quantity): Grid {
  const unit = commonUnit(data.joints, quantity);
  const times: Row = [itemAt(data.t_s, instant), a?.t_s[0] ?? null, b?.t_s[0] ?? null];
  const columns = [{ name: "Joint", unit: "", format: "" }];
  for (const name of ["Cursor", "A", "B", "B \u2212 A"]) columns.push({ name, unit, format: ".5g" });
  const line = (name: string, [at, atA, atB]: Row): Cell[] => [name, at, atA, atB, difference(atA, atB)];
  const rows = data.joints.map((joint, index) =>
    line(jointTitle(joint, unit === "" ? kQuantities[quantity].unit(joint) : ""), [
      data[quantity][index]?.[instant] ?? null,
      a?.[quantity][index]?.[0] ?? null,
      b?.[quantity][index]?.[0] ?? null,
    ]),
  );
  rows.unshift(line("Time [s]", times));
  return { caption: `${kQuantities[quantity].name} at A and B`, columns, rows };
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
