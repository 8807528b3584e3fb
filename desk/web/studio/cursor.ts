/**
 * The instant that is looked at, and two that are compared: s of the recording's own time, null: none.
 * Set by setCursor() alone.
 */
const cursor = { at: null, a: null, b: null };
/** Called with the name of what was moved. */
const cursorWatchers = [];
/** While the arm moves by itself the pointer does not move it. */
let holdsPointer = false;

function setCursor(name, time) {
  if (cursor[name] === time) return;
  cursor[name] = time;
  for (const watch of cursorWatchers) watch(name);
  for (const figure of timeFigures()) placeCursors(figure);
}

function clearCursors() {
  for (const name of Object.keys(cursor)) setCursor(name, null);
}

/** A chart over time moves the cursor; A and B are set by clicks and by their keys. */
function followChart(figure) {
  const { chart, host } = figure;
  const lines = element("div", { class: "cursors", "aria-hidden": "true" });
  for (const name of Object.keys(cursor)) {
    lines.append(element("i", { class: `cursor-${name}`, hidden: "" }, name === "at" ? "" : name.toUpperCase()));
  }
  host.append(lines);
  figure.cursorLines = lines;
  chart.on("updateAxisPointer", ({ axesInfo }) => {
    const axis = axesInfo?.find(({ axisDim }) => axisDim === "x");
    if (axis && !holdsPointer) setCursor("at", axis.value);
  });
  chart.getZr().on("click", ({ offsetX, offsetY, event }) => {
    if (!chart.containPixel("grid", [offsetX, offsetY])) return;
    setCursor(event.shiftKey ? "b" : "a", chart.convertFromPixel({ xAxisIndex: 0 }, offsetX));
  });
  chart.on("rendered", () => placeCursors(figure));
  host.addEventListener("keydown", markByKey);
}

/** The keys of A and B, where the focus is on what shows the time. */
function markByKey(event) {
  const { key, ctrlKey, altKey, metaKey } = event;
  if (ctrlKey || altKey || metaKey || cursor.at === null || !["a", "b"].includes(key)) return;
  setCursor(key, cursor.at);
  say(`${key.toUpperCase()} is at ${timeWords(cursor.at)}`);
  event.preventDefault();
}

function timeWords(time) {
  return time === null ? "–" : withUnit(formatNumber(time, ".3f"), "s");
}

/** Beside the chart's own drawing, which takes longer to make anew. */
function placeCursors(figure) {
  if (!figure.cursorLines || !figure.option) return;
  const sides = plotSides(figure);
  for (const line of figure.cursorLines.children) {
    const time = cursor[line.className.split("-").at(-1)];
    const x = time === null ? NaN : figure.chart.convertToPixel({ xAxisIndex: 0 }, time);
    line.hidden = !(x >= sides.x[0] && x <= sides.x[1]);
    if (!line.hidden) line.style.cssText = `left:${x}px;top:${sides.y[1]}px;height:${sides.y[0] - sides.y[1]}px`;
  }
}
