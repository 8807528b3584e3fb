import type { Axis, Chart, Series, Value } from "./document";
import type { ItemApi, ItemParams } from "./echarts";
import type { Pair } from "./figure_type";
import { itemAt } from "./lists";
import { isDashed, withOpacity } from "./palette";

/** The axis that a series belongs to. */
export function yAxisOf(chart: Chart, series: Series): Axis {
  return itemAt(chart.y, series.y_axis);
}

/** Gaps, and values that a logarithmic axis cannot show, are null. */
export function drawable(value: Value, axis: Axis) {
  return value !== null && axis.log && value <= 0 ? null : value;
}

/** The part of a band between two gaps, in pixels. */
type Piece = { low: Pair; high: Pair }[];

function bandSeries(common: object, series: Series, color: string, x: Axis, y: Axis) {
  const data = series.x.map((value, index) => [
    drawable(value, x),
    drawable(series.y[index] ?? null, y),
    drawable(series.y_upper?.[index] ?? null, y),
  ]);
  return {
    ...common,
    type: "custom",
    data,
    dimensions: ["x", "lower", "upper"],
    encode: { x: 0, y: [1, 2] },
    clip: true,
    itemStyle: { color },
    // The whole band is one shape, drawn with the first point, so that no seams show.
    renderItem: (params: ItemParams, api: ItemApi) => {
      if (params.dataIndexInside !== 0) return null;
      const pieces: Piece[] = [];
      let piece: Piece = [];
      for (let index = 0; index < params.dataInsideLength; ++index) {
        const [x, lower, upper] = [api.value(0, index), api.value(1, index), api.value(2, index)];
        if ([x, lower, upper].every(Number.isFinite)) {
          piece.push({ low: api.coord([x, lower]), high: api.coord([x, upper]) });
        } else if (piece.length > 0) {
          pieces.push(piece);
          piece = [];
        }
      }
      if (piece.length > 0) pieces.push(piece);
      const outline = (points: Piece) => [
        ...points.map((point) => point.low),
        ...points.map((point) => point.high).reverse(),
      ];
      return {
        type: "group",
        children: pieces.map((points) => ({
          type: "polygon",
          shape: { points: outline(points) },
          style: { fill: withOpacity(color, 0.24), stroke: color, lineWidth: 0.6 },
        })),
      };
    },
  };
}

function barSeries(common: object, series: Series, color: string, y: Axis) {
  const data = series.y.map((value, bar) => [series.x[bar], series.x[bar + 1], drawable(value, y)]);
  return {
    ...common,
    type: "custom",
    data,
    dimensions: ["from", "to", "value"],
    encode: { x: [0, 1], y: 2 },
    clip: true,
    itemStyle: { color },
    renderItem: (params: ItemParams, api: ItemApi) => {
      const value = api.value(2);
      if (!Number.isFinite(value)) return null;
      const plot = params.coordSys;
      const [left, top] = api.coord([api.value(0), value]);
      const base = y.log ? plot.y + plot.height : api.coord([api.value(0), 0])[1];
      const right = api.coord([api.value(1), value])[0];
      return {
        type: "rect",
        shape: {
          x: left,
          y: Math.min(top, base),
          width: Math.max(right - left, 0.5),
          height: Math.abs(base - top),
        },
        style: { fill: withOpacity(color, 0.75), stroke: color, lineWidth: 0.6 },
        emphasis: { style: { fill: color } },
      };
    },
  };
}

export function drawnSeries(series: Series, index: number, color: string, chart: Chart) {
  const y = yAxisOf(chart, series);
  const common = { id: `s${index}`, name: series.name, yAxisIndex: series.y_axis, z: 2 };
  if (series.kind === "band") return { ...bandSeries(common, series, color, chart.x, y), z: 1 };
  if (series.kind === "bars") return barSeries(common, series, color, y);
  const data = series.x.map((x, i) => [drawable(x, chart.x), drawable(series.y[i] ?? null, y)]);
  if (series.kind === "points") {
    return {
      ...common,
      type: "scatter",
      data,
      progressive: false,
      progressiveThreshold: Infinity,
      large: true,
      largeThreshold: 600,
      symbolSize: data.length > 600 ? 2.5 : data.length > 100 ? 4 : 7,
      itemStyle: { color, opacity: 1, borderWidth: 0 },
    };
  }
  return {
    ...common,
    type: "line",
    data,
    step: series.kind === "steps" ? "end" : false,
    showSymbol: series.kind === "line" && data.length <= 30,
    symbol: "circle",
    symbolSize: 5,
    itemStyle: { color },
    lineStyle: {
      color,
      width: series.tone === "faint" ? 1.1 : 1.6,
      type: isDashed(series) ? [6, 4] : "solid",
      join: "round",
    },
    emphasis: { disabled: true },
  };
}
