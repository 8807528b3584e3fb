import { plotSides } from "../report/cursors";
import { element } from "../report/element";
import { chartOf, type Figure } from "../report/figure_type";
import { formatNumber, withUnit } from "../report/format";
import { say } from "../report/keys";
import { timeFigures } from "./charts";

/**
 * The instant that is looked at, and two that are compared: s of the recording's own time, null: none.
 * Set by setCursor() alone.
 */
export const cursor: Record<CursorName, number | null> = { at: null, a: null, b: null };

export type CursorName = "at" | "a" | "b";

const kNames: CursorName[] = ["at", "a", "b"];

let watcher: (name: CursorName) => void = () => {};

/** Whom to tell what was moved. */
export function watchCursors(told: (name: CursorName) => void) {
  watcher = told;
}

let holdsPointer = false;

/** While the arm moves by itself the pointer does not move the cursor. */
export function holdPointer(held: boolean) {
  holdsPointer = held;
}

export function setCursor(name: CursorName, time: number | null) {
  if (cursor[name] === time) return;
  cursor[name] = time;
  watcher(name);
  for (const figure of timeFigures()) placeCursors(figure);
}

export function clearCursors() {
  for (const name of kNames) setCursor(name, null);
}

/** A chart over time moves the cursor; A and B are set by clicks and by their keys. */
export function followChart(figure: Figure) {
  const { host } = figure;
  const chart = chartOf(figure);
  const lines = element("div", { class: "cursors", "aria-hidden": "true" });
  for (const name of kNames) {
    lines.append(element("i", { class: `cursor-${name}`, "data-cursor": name, hidden: "" }, name === "at" ? "" : name.toUpperCase()));
  }
  host.append(lines);
  figure.cursorLines = lines;
  chart.on("updateAxisPointer", (event) => {
    const { axesInfo } = event as { axesInfo?: { axisDim: string; value: number }[] };
    const axis = axesInfo?.find(({ axisDim }) => axisDim === "x");
    if (axis && !holdsPointer) setCursor("at", axis.value);
  });
  chart.getZr().on("click", ({ offsetX, offsetY, event }) => {
    if (!chart.containPixel("grid", [offsetX, offsetY])) return;
    const { shiftKey } = event as unknown as MouseEvent;
    setCursor(shiftKey ? "b" : "a", chart.convertFromPixel({ xAxisIndex: 0 }, offsetX) as unknown as number);
  });
  chart.on("rendered", () => placeCursors(figure));
  host.addEventListener("keydown", markByKey);
}

/** The keys of A and B, where the focus is on what shows the time. */
export function markByKey(event: KeyboardEvent) {
  const { key, ctrlKey, altKey, metaKey } = event;
  if (ctrlKey || altKey || metaKey || cursor.at === null || (key !== "a" && key !== "b")) return;
  setCursor(key, cursor.at);
  say(`${key.toUpperCase()} is at ${timeWords(cursor.at)}`);
  event.preventDefault();
}

export function timeWords(time: number | null) {
  return time === null ? "–" : withUnit(formatNumber(time, ".3f"), "s");
}

/** Beside the chart's own drawing, which takes longer to make anew. */
function placeCursors(figure: Figure) {
  if (!figure.cursorLines || !figure.option) return;
  const sides = plotSides(figure);
  for (const line of figure.cursorLines.querySelectorAll<HTMLElement>("i")) {
    const time = cursor[line.dataset.cursor as CursorName];
    const x = time === null ? NaN : (chartOf(figure).convertToPixel({ xAxisIndex: 0 }, time) as unknown as number);
    line.hidden = !(x >= sides.x[0] && x <= sides.x[1]);
    if (!line.hidden) line.style.cssText = `left:${x}px;top:${sides.y[1]}px;height:${sides.y[0] - sides.y[1]}px`;
  }
}
