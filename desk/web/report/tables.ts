import type { Cell, Column, Grid, Table } from "./document";
import { element, within } from "./element";
import { formatNumber, unitInBrackets } from "./format";

/** Text that a narrow column does not break: units, single words. */
const kShortText = 12;

/** The table alone; it scrolls by itself where the window is narrower: see watchTables(). */
export function scrollingTable(table: Grid) {
  const text = (index: number) => table.rows.some((row) => typeof row[index] === "string");
  const head = element("tr");
  table.columns.forEach((column, index) => {
    const cell = element("th", { scope: "col", class: text(index) ? "" : "number" }, column.name);
    if (column.unit !== "") {
      cell.append(" ", element("span", { class: "unit" }, unitInBrackets(column.unit)));
    }
    head.append(cell);
  });
  const body = element("tbody");
  for (const row of table.rows) body.append(tableRow(row, table.columns));
  const caption = element("caption", {}, element("span", {}, table.caption));
  const grid = element("table", {}, caption, element("thead", {}, head), body);
  const hint = element("p", { class: "scroll-hint", hidden: "" }, "Wider than shown: scroll \u2192");
  return element("div", {}, hint, element("div", { class: "scroll" }, grid));
}

export function tableElement(table: Table, place: string) {
  const root = element("div", { class: "card", "data-block": place }, scrollingTable(table));
  if (table.note !== "") root.append(element("p", { class: "remark" }, table.note));
  return root;
}

function tableRow(row: Cell[], columns: Column[]) {
  const line = element("tr");
  row.forEach((value, index) => {
    const isText = typeof value === "string";
    const shown = isText ? value : formatNumber(value, columns[index]?.format ?? "");
    const named = index === 0 && isText;
    const kind = isText ? (value.length <= kShortText ? "short" : "") : "number";
    const attributes = { class: kind, ...(named ? { scope: "row" } : {}) };
    line.append(element(named ? "th" : "td", attributes, shown));
  });
  return line;
}

let widths: ResizeObserver | undefined;

/**
 * A table wider than its place says so, and takes the focus so that the arrow keys scroll it. The place changes with the
 * window, the table with its numbers.
 */
export function watchTables(root: ParentNode) {
  widths ??= new ResizeObserver((entries) => {
    for (const { target } of entries) {
      const scroll = target.closest<HTMLElement>(".scroll");
      if (scroll !== null) markWidth(scroll);
    }
  });
  for (const scroll of root.querySelectorAll(".scroll")) {
    for (const watched of [scroll, ...scroll.children]) widths.observe(watched);
  }
}

function markWidth(scroll: HTMLElement) {
  const wide = scroll.scrollWidth > scroll.clientWidth + 1;
  if (wide === scroll.hasAttribute("tabindex")) return;
  const name = `${within(scroll, "caption").textContent}, scrolls sideways`;
  for (const [key, value] of Object.entries({ tabindex: "0", role: "region", "aria-label": name })) {
    if (wide) scroll.setAttribute(key, value);
    else scroll.removeAttribute(key);
  }
  (scroll.previousElementSibling as HTMLElement).hidden = !wide;
}
