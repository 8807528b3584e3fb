import type { Axis, Chart, Series, Value } from "./document";
import { axisTitle, csvText, formatNumber, withUnit } from "./format";
import { itemAt } from "./lists";
import { yAxisOf } from "./series";

export function chartCsv(chart: Chart) {
  const head: string[] = [];
  const columns: Value[][] = [];
  for (const series of chart.series) {
    const y = yAxisOf(chart, series);
    head.push(`${series.name}: ${axisTitle(chart.x)}`);
    columns.push(series.x);
    head.push(`${series.name}${series.kind === "band" ? " lower" : ""}: ${axisTitle(y)}`);
    columns.push(series.y);
    if (series.kind === "band") {
      head.push(`${series.name} upper: ${axisTitle(y)}`);
      columns.push(series.y_upper ?? []);
    }
  }
  const length = Math.max(...columns.map((column) => column.length));
  const rows = Array.from({ length }, (_, row) => columns.map((column) => column[row]));
  return csvText([head, ...rows]);
}

/** Each of a few spans, of many how often what comes. */
function spanWords({ spans, x }: Chart, at: (value: Value, axis: Axis) => string) {
  const kMostTold = 6;
  if (spans.length <= kMostTold) {
    return spans.map(({ from, to, label }) => `${label} from ${at(from, x)} to ${at(to, x)}`);
  }
  const counts = new Map();
  for (const { label } of spans) counts.set(label, (counts.get(label) ?? 0) + 1);
  return [...counts].map(([label, count]) => `${label}, ${count} times`);
}

/** What the title does not say. */
export function chartWords(chart: Chart) {
  const ys = chart.y.map(axisTitle).join(" and ");
  const at = (value: Value, axis: Axis) => withUnit(formatNumber(value, ".6g"), axis.unit);
  const events = chart.events.map((event) => `${event.label} at ${at(event.x, chart.x)}`);
  const levels = chart.levels.map((level) => `${level.label} at ${at(level.y, itemAt(chart.y, 0))}`);
  const spans = spanWords(chart, at);
  const marks = [...events, ...spans, ...levels];
  const marked = marks.length > 0 ? ` Marked: ${marks.join("; ")}.` : "";
  return `${ys} against ${axisTitle(chart.x)}.${marked}`;
}

/** The values themselves where they are few and stand at the same x, else the range of each series. */
export function chartNumbers(chart: Chart) {
  const [first, ...others] = chart.series;
  const isLine = ({ kind }: Series) => kind !== "bars" && kind !== "band";
  const alike = (other: Series) => isLine(other) && other.x.join() === first?.x.join();
  if (first !== undefined && isLine(first) && first.x.length <= 30 && others.every(alike)) {
    const columns = chart.series.map((series) => column(series.name, yAxisOf(chart, series).unit));
    const rows = first.x.map((x, index) => [x, ...chart.series.map((series) => series.y[index] ?? null)]);
    return { columns: [column(chart.x.name, chart.x.unit), ...columns], rows };
  }
  return {
    columns: ["Series", "Values drawn", "Lowest", "Highest"].map((name) => column(name, "")),
    rows: chart.series.map((series) => seriesRange(series, chart)),
  };
}

export function column(name: string, unit: string) {
  return { name, unit, format: ".5g" };
}

function seriesRange(series: Series, chart: Chart) {
  const number = (value: Value, axis: Axis) => withUnit(formatNumber(value, ".5g"), axis.unit);
  const extreme = (values: Value[], isBeyond: (value: number, best: number) => boolean) => {
    let best = -1;
    values.forEach((value, index) => {
      if (value !== null && (best < 0 || isBeyond(value, values[best] ?? NaN))) best = index;
    });
    if (best < 0) return null;
    return `${number(itemAt(values, best), yAxisOf(chart, series))} at ${number(itemAt(series.x, best), chart.x)}`;
  };
  const count = series.y.filter((value) => value !== null).length;
  const highest = extreme(series.y_upper ?? series.y, (a, b) => a > b);
  return [series.name, count, extreme(series.y, (a, b) => a < b), highest];
}
