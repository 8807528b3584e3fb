const kKeyWords =
  "Arrow keys show values, + and - zoom, shift and an arrow moves the range, 0 shows all of it.";
const kArrows = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const kSmallestShare = 0.01;

/** Makes a figure whose kind has a cursor answer the keyboard; returns the hint shown meanwhile. */
function takeKeys(figure) {
  const { host } = figure;
  const hint = element("p", { class: "keys", id: `${host.getAttribute("aria-labelledby")}-keys` });
  hint.append(kKeyWords);
  host.setAttribute("role", "application");
  host.setAttribute("aria-roledescription", "chart");
  host.setAttribute("tabindex", "0");
  host.setAttribute("aria-describedby", `${host.getAttribute("aria-describedby")} ${hint.id}`);
  host.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (obey(figure, event)) event.preventDefault();
  });
  host.addEventListener("blur", () => hideTip(figure));
  return hint;
}

/** Whether the key meant anything to the figure. */
function obey(figure, { key, shiftKey }) {
  const arrow = kArrows[key];
  if (arrow && shiftKey) moveRange(figure, arrow);
  else if (arrow) return moveCursor(figure, arrow);
  else if (key === "+" || key === "=") zoomBy(figure, 0.5);
  else if (key === "-") zoomBy(figure, 2);
  else if (key === "0") zoomByKey(figure, () => ({ start: 0, end: 100 }));
  else if (key === "Escape") hideTip(figure);
  else return false;
  return true;
}

/** What a reader who does not see the picture hears. */
function say(words) {
  document.getElementById("spoken").textContent = words;
}

function hideTip({ chart }) {
  chart.dispatchAction({ type: "hideTip" });
  chart.dispatchAction({ type: "updateAxisPointer", currTrigger: "leave" });
}

function zoomByKey(figure, change) {
  hideTip(figure);
  zoomTo(figure, change);
  const { x } = figure.block;
  const ends = visibleRange(figure, "x").map((end) => formatSignificant(end, 4));
  say(withUnit(`${x.name} ${ends.join(" to ")}`, x.unit));
}

/** Zooms about the middle of what is shown. */
function zoomBy(figure, factor) {
  zoomByKey(figure, ({ start, end }) => {
    const share = Math.min(100, Math.max(kSmallestShare, (end - start) * factor));
    const from = Math.min(100 - share, Math.max(0, (start + end - share) / 2));
    return { start: from, end: from + share };
  });
}

/** A map's second zoom is that of its y axis. */
function moveRange(figure, [right, up]) {
  const isMap = figure.block.type === "heatmap";
  zoomByKey(figure, ({ start, end }, index) => {
    const steps = isMap && index === 1 ? up : right;
    const way = Math.max(-start, Math.min(100 - end, steps * 0.2 * (end - start)));
    return { start: start + way, end: end + way };
  });
}

/** The plot's sides in pixels of the picture. */
function plotSides({ option, host }) {
  const { left, right, top, bottom } = option.grid;
  return { x: [left, host.clientWidth - right], y: [host.clientHeight - bottom, top] };
}

/** From where to where the axis is shown now. */
function visibleRange(figure, axis) {
  return plotSides(figure)[axis].map((pixel) =>
    figure.chart.convertFromPixel({ [`${axis}AxisIndex`]: 0 }, pixel),
  );
}

/** Shows the tip of the next place in the arrow's direction; false where there is none that way. */
function moveCursor(figure, arrow) {
  const place = figure.kind.cursor(figure, arrow);
  if (place === null) return false;
  figure.chart.dispatchAction({ type: "showTip", ...place });
  const tip = figure.host.querySelector(".tip table");
  const lines = tip ? [...tip.querySelectorAll("caption, tr")] : [];
  say(lines.map((line) => [...line.childNodes].map((each) => each.textContent).join(" ")).join("; "));
  return true;
}

/** Lines: a cursor in pixels, at which every series has its value. Points and bars: each by itself. */
function chartCursor(figure, [right, up]) {
  if (up !== 0) return null;
  if (showsItems(figure.block)) return nextItem(figure, right);
  const { x, y } = plotSides(figure);
  const places = plotPlaces(figure, x);
  if (places.length === 0) return null;
  const now = figure.cursor ?? (x[0] + x[1]) / 2 - right;
  const step = figure.cursor === null ? 1 : (x[1] - x[0]) / 50;
  const ahead = places.filter((place) => right * (place - now) >= step);
  const nearest = (best, place) => (right * (place - best) < 0 ? place : best);
  const last = right > 0 ? places.at(-1) : places[0];
  figure.cursor = ahead.length > 0 ? ahead.reduce(nearest) : last;
  return { x: figure.cursor, y: (y[0] + y[1]) / 2 };
}

/** Where between the sides the shown series have points, from left to right. */
function plotPlaces({ block, chart, hidden }, [left, right]) {
  const shown = block.series.filter(({ name }) => !hidden.has(name));
  const all = new Set(shown.flatMap((series) => series.x.filter((x) => x !== null)));
  return [...all]
    .map((x) => chart.convertToPixel({ xAxisIndex: 0 }, x))
    .filter((pixel) => pixel >= left && pixel <= right)
    .sort((a, b) => a - b);
}

/** Points and bars of the range shown, from left to right; of many, every n-th. */
function nextItem(figure, right) {
  const { block, chart, hidden } = figure;
  const [low, high] = visibleRange(figure, "x");
  const items = block.series.flatMap((series, index) => {
    const axis = block.y[series.y_axis];
    const shown = hidden.has(series.name) ? [] : [...series.y.keys()];
    return shown
      .filter((at) => drawable(series.y[at], axis) !== null && drawable(series.x[at], block.x) !== null)
      .filter((at) => series.x[at] >= low && series.x[at] <= high)
      .map((at) => ({ series, index, at, x: series.x[at] }));
  });
  if (items.length === 0) return null;
  items.sort((a, b) => a.x - b.x);
  const now = items.findIndex(
    ({ index, at }) => index === figure.cursor?.index && at === figure.cursor.at,
  );
  const step = right * Math.max(1, Math.round(items.length / 100));
  const next = now < 0 ? Math.floor(items.length / 2) : now + step;
  figure.cursor = items[Math.min(items.length - 1, Math.max(0, next))];
  const { series, index, at, x } = figure.cursor;
  const colors = seriesColors(block.series, currentLook());
  const axes = { xAxisIndex: 0, yAxisIndex: series.y_axis };
  return tipAt(
    chart.convertToPixel(axes, [x, series.y[at]]),
    itemTip(block, colors, { seriesId: `s${index}`, dataIndex: at }),
  );
}

/** A tip of its own: not every shape drawn has one that could be called up by the item's number. */
function tipAt([x, y], html) {
  return { x, y, tooltip: { formatter: () => html } };
}

/** The next cell that has a value, from the middle on. */
function heatmapCursor(figure, [right, up]) {
  const [x, y] = ["x", "y"].map((axis) => visibleRange(figure, axis));
  const cells = heatmapCells(figure.block)
    .map((value) => ({ value, x: value[0], y: value[1], column: value[3], row: value[4] }))
    .filter((cell) => x[0] <= cell.x && cell.x <= x[1] && y[0] <= cell.y && cell.y <= y[1]);
  if (cells.length === 0) return null;
  const { column, row } = figure.cursor ?? {};
  const from = cells.find((cell) => cell.column === column && cell.row === row);
  figure.cursor = from ? nextCell(cells, from, right, up) : middleCell(cells, x, y);
  const center = [figure.cursor.x, figure.cursor.y];
  const at = figure.chart.convertToPixel({ xAxisIndex: 0, yAxisIndex: 0 }, center);
  return tipAt(at, heatmapTip(figure.block, figure.cursor));
}

function nextCell(cells, from, right, up) {
  const ahead = (cell) => right * (cell.column - from.column) + up * (cell.row - from.row);
  const onWay = (cell) => (right === 0 ? cell.column === from.column : cell.row === from.row);
  return cells
    .filter((cell) => onWay(cell) && ahead(cell) > 0)
    .reduce((best, cell) => (best === from || ahead(cell) < ahead(best) ? cell : best), from);
}

function middleCell(cells, x, y) {
  const share = (value, [low, high]) => Math.abs((value - (low + high) / 2) / (high - low));
  const away = (cell) => share(cell.x, x) + share(cell.y, y);
  return cells.reduce((best, cell) => (away(cell) < away(best) ? cell : best));
}
