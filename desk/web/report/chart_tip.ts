import type { Axis, Chart, Series, Value } from "./document";
import { escapeHtml, formatNumber, formatSignificant, withUnit } from "./format";
import { itemAt } from "./lists";
import { swatch } from "./palette";
import { yAxisOf } from "./series";

function tipRow(series: Series, color: string, value: string) {
  return `<tr><td>${swatch(series, color)}${escapeHtml(series.name)}</td><td>${value}</td></tr>`;
}

function tipValue(series: Series, axis: Axis, at: number) {
  const number = (each: Value | undefined) => formatNumber(each ?? null, ".5g");
  const value = series.y[at] ?? null;
  if (value === null) return "–";
  const text =
    series.kind === "band" ? `${number(value)} to ${number(series.y_upper?.[at])}` : number(value);
  return escapeHtml(withUnit(text, axis.unit));
}

/** Index of the point nearest to x (steps: of the last one at or before x); -1 beyond the ends. */
export function pointAt(series: Series, x: number) {
  const last = series.x.length - 1;
  if (series.x[0] === null || series.x[last] === null) return series.x.indexOf(x);
  const xAt = (index: number) => series.x[index] ?? 0;
  const slack = (xAt(last) - xAt(0)) / 200;
  if (x < xAt(0) - slack || x > xAt(last) + slack) return -1;
  let [low, high] = [0, last];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (xAt(middle) <= x) low = middle;
    else high = middle;
  }
  if (xAt(high) <= x) return high;
  if (series.kind === "steps") return low;
  return x - xAt(low) <= xAt(high) - x ? low : high;
}

/** Points and bars show a tip each, lines one for all at an x. */
export function showsItems(chart: Chart) {
  return chart.series.every((each) => each.kind === "points" || each.kind === "bars");
}

/** What ECharts says of the item under the pointer. */
export interface TipItem {
  seriesId?: string;
  dataIndex: number;
}

/** At one x the value of every shown series: their points need not share that x. */
export function axisTip(chart: Chart, colors: string[], x: number, isShown: (name: string) => boolean) {
  const rows = chart.series.flatMap((series, index) => {
    const at = series.kind === "points" || !isShown(series.name) ? -1 : pointAt(series, x);
    if (at < 0) return [];
    return [tipRow(series, itemAt(colors, index), tipValue(series, yAxisOf(chart, series), at))];
  });
  for (const { from, to, label } of chart.spans) {
    if (from !== null && to !== null && x >= from && x <= to) rows.push(`<tr><td colspan="2">${escapeHtml(label)}</td></tr>`);
  }
  return tipTable(`${chart.x.name} ${withUnit(formatSignificant(x, 6), chart.x.unit)}`, rows);
}

export function itemTip(chart: Chart, colors: string[], item: TipItem) {
  if (!/^s\d+$/.test(item.seriesId ?? "")) return "";
  const index = Number(item.seriesId?.slice(1));
  const series = itemAt(chart.series, index);
  const [x, at] = [series.x, item.dataIndex];
  const number = (each: Value | undefined) => formatNumber(each ?? null, ".5g");
  const place = series.kind === "bars" ? `${number(x[at])} to ${number(x[at + 1])}` : number(x[at]);
  const row = tipRow(series, itemAt(colors, index), tipValue(series, yAxisOf(chart, series), at));
  return tipTable(`${chart.x.name} ${withUnit(place, chart.x.unit)}`, [row]);
}

function tipTable(caption: string, rows: string[]) {
  return `<table><caption>${escapeHtml(caption)}</caption>${rows.join("")}</table>`;
}
