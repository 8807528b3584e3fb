import { itemTip, showsItems } from "./chart_tip";
import type { Chart } from "./document";
import { chartOf, type Arrow, type CellPlace, type Figure, type ItemPlace, type Pair, type Tip } from "./figure_type";
import { heatmapCells, heatmapTip } from "./heatmap";
import { currentLook } from "./look";
import { seriesColors } from "./palette";
import { drawable, yAxisOf } from "./series";

/** The plot's sides in pixels of the picture. */
export function plotSides({ option, host }: Figure): { x: Pair; y: Pair } {
  const { left, right, top, bottom } = option?.grid ?? { left: 0, right: 0, top: 0, bottom: 0 };
  return { x: [left, host.clientWidth - right], y: [host.clientHeight - bottom, top] };
}

/** From where to where the axis is shown now. */
export function visibleRange(figure: Figure, axis: "x" | "y"): Pair {
  const at = (pixel: number) => chartOf(figure).convertFromPixel({ [`${axis}AxisIndex`]: 0 }, pixel) as unknown as number;
  const [low, high] = plotSides(figure)[axis];
  return [at(low), at(high)];
}

/** Lines: a cursor in pixels, at which every series has its value. Points and bars: each by itself. */
export function chartCursor(figure: Figure, [right, up]: Arrow): Tip | null {
  const { block, cursor } = figure;
  if (up !== 0 || block.type !== "chart") return null;
  if (showsItems(block)) return nextItem(figure, block, right);
  const { x, y } = plotSides(figure);
  const places = plotPlaces(figure, block, x);
  const end = right > 0 ? places.at(-1) : places[0];
  if (end === undefined) return null;
  const before = typeof cursor === "number" ? cursor : null;
  const now = before ?? (x[0] + x[1]) / 2 - right;
  const step = before === null ? 1 : (x[1] - x[0]) / 50;
  const ahead = places.filter((place) => right * (place - now) >= step);
  const nearest = (best: number, place: number) => (right * (place - best) < 0 ? place : best);
  const place = ahead.length > 0 ? ahead.reduce(nearest) : end;
  figure.cursor = place;
  return { x: place, y: (y[0] + y[1]) / 2 };
}

/** Where between the sides the shown series have points, from left to right. */
function plotPlaces(figure: Figure, block: Chart, [left, right]: Pair) {
  const shown = block.series.filter(({ name }) => !figure.hidden.has(name));
  const all = new Set(shown.flatMap((series) => series.x.filter((x) => x !== null)));
  return [...all]
    .map((x) => chartOf(figure).convertToPixel({ xAxisIndex: 0 }, x) as unknown as number)
    .filter((pixel) => pixel >= left && pixel <= right)
    .sort((a, b) => a - b);
}

/** Points and bars of the range shown, from left to right; of many, every n-th. */
function nextItem(figure: Figure, block: Chart, right: number): Tip | null {
  const items = itemsShown(figure, block);
  const { cursor } = figure;
  const isHere = (item: ItemPlace) =>
    cursor !== null && typeof cursor === "object" && "at" in cursor && item.index === cursor.index && item.at === cursor.at;
  const now = items.findIndex(isHere);
  const step = right * Math.max(1, Math.round(items.length / 100));
  const next = now < 0 ? Math.floor(items.length / 2) : now + step;
  const item = items[Math.min(items.length - 1, Math.max(0, next))];
  if (item === undefined) return null;
  figure.cursor = item;
  const { series, index, at, x } = item;
  const colors = seriesColors(block.series, currentLook());
  const axes = { xAxisIndex: 0, yAxisIndex: series.y_axis };
  return tipAt(
    pixelOf(figure, axes, [x, series.y[at] ?? 0]),
    itemTip(block, colors, { seriesId: `s${index}`, dataIndex: at }),
  );
}

/** From left to right. */
function itemsShown(figure: Figure, block: Chart): ItemPlace[] {
  const [low, high] = visibleRange(figure, "x");
  const items: ItemPlace[] = [];
  block.series.forEach((series, index) => {
    if (figure.hidden.has(series.name)) return;
    const axis = yAxisOf(block, series);
    series.y.forEach((value, at) => {
      const x = drawable(series.x[at] ?? null, block.x);
      if (x === null || drawable(value, axis) === null) return;
      if (x >= low && x <= high) items.push({ series, index, at, x });
    });
  });
  return items.sort((a, b) => a.x - b.x);
}

/** Where values are in the picture. */
function pixelOf(figure: Figure, axes: { xAxisIndex: number; yAxisIndex: number }, [x, y]: Pair): Pair {
  const [right, down] = chartOf(figure).convertToPixel(axes, [x, y]);
  return [right ?? 0, down ?? 0];
}

/** A tip of its own: not every shape drawn has one that could be called up by the item's number. */
function tipAt([x, y]: Pair, html: string): Tip {
  return { x, y, tooltip: { formatter: () => html } };
}

/** The next cell that has a value, from the middle on. */
export function heatmapCursor(figure: Figure, [right, up]: Arrow): Tip | null {
  const { block, cursor } = figure;
  if (block.type !== "heatmap") return null;
  const [x, y] = [visibleRange(figure, "x"), visibleRange(figure, "y")];
  const cells = heatmapCells(block)
    .map((value): CellPlace => ({ value, x: value[0], y: value[1], column: value[3], row: value[4] }))
    .filter((cell) => x[0] <= cell.x && cell.x <= x[1] && y[0] <= cell.y && cell.y <= y[1]);
  if (cells.length === 0) return null;
  const isHere = (cell: CellPlace) =>
    cursor !== null && typeof cursor === "object" && "row" in cursor && cell.column === cursor.column && cell.row === cursor.row;
  const from = cells.find(isHere);
  const cell = from ? nextCell(cells, from, right, up) : middleCell(cells, x, y);
  figure.cursor = cell;
  return tipAt(pixelOf(figure, { xAxisIndex: 0, yAxisIndex: 0 }, [cell.x, cell.y]), heatmapTip(block, cell));
}

function nextCell(cells: CellPlace[], from: CellPlace, right: number, up: number) {
  const ahead = (cell: CellPlace) => right * (cell.column - from.column) + up * (cell.row - from.row);
  const onWay = (cell: CellPlace) => (right === 0 ? cell.column === from.column : cell.row === from.row);
  return cells
    .filter((cell) => onWay(cell) && ahead(cell) > 0)
    .reduce((best, cell) => (best === from || ahead(cell) < ahead(best) ? cell : best), from);
}

function middleCell(cells: CellPlace[], x: Pair, y: Pair) {
  const share = (value: number, [low, high]: Pair) => Math.abs((value - (low + high) / 2) / (high - low));
  const away = (cell: CellPlace) => share(cell.x, x) + share(cell.y, y);
  return cells.reduce((best, cell) => (away(cell) < away(best) ? cell : best));
}
