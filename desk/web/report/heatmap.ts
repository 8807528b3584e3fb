import { axisStyle, edgeLabelOption, tooltipStyle } from "./axes";
import { kNameRow, kPlotLeft, zoomBrush } from "./chart";
import { column } from "./chart_words";
import type { Axis, Heatmap, Value } from "./document";
import type { ItemApi, ItemParams } from "./echarts";
import type { CellValue } from "./figure_type";
import { axisTitle, csvText, escapeHtml, formatSignificant, withUnit } from "./format";
import { kFontFamily, type Look } from "./palette";

const kHeatmapBottom = 46;

export function heatmapHeight() {
  return 360;
}

/** Cells have an edge on either side. */
function edgeOf(edges: Value[], at: number): number {
  return edges[at] ?? NaN;
}

export function heatmapCells(map: Heatmap) {
  const columns = map.x_edges.length - 1;
  return map.value.flatMap((value, index): CellValue[] => {
    if (value === null) return [];
    const column = index % columns;
    const row = Math.floor(index / columns);
    const middle = (edges: Value[], at: number) => (edgeOf(edges, at) + edgeOf(edges, at + 1)) / 2;
    return [[middle(map.x_edges, column), middle(map.y_edges, row), value, column, row]];
  });
}

export function heatmapScale(map: Heatmap) {
  const values = map.value.filter((value) => value !== null);
  let low = map.value_axis.min ?? values.reduce((a, b) => Math.min(a, b), Infinity);
  let high = map.value_axis.max ?? values.reduce((a, b) => Math.max(a, b), -Infinity);
  if (!Number.isFinite(low) || !Number.isFinite(high)) return { low: 0, high: 1 };
  if (map.diverging && map.value_axis.min === null && map.value_axis.max === null) {
    high = Math.max(Math.abs(low), Math.abs(high));
    low = -high;
  }
  return low < high ? { low, high } : { low: low - 0.5, high: high + 0.5 };
}

export function heatmapTip(map: Heatmap, item: { value: CellValue }) {
  const [, , value, column, row] = item.value;
  const range = (edges: Value[], at: number, unit: string) =>
    withUnit(`${formatSignificant(edgeOf(edges, at), 5)} to ${formatSignificant(edgeOf(edges, at + 1), 5)}`, unit);
  const lines: [string, string][] = [
    [map.x.name, range(map.x_edges, column, map.x.unit)],
    [map.y.name, range(map.y_edges, row, map.y.unit)],
    [map.value_axis.name, withUnit(formatSignificant(value, 5), map.value_axis.unit)],
  ];
  const rows = lines.map(
    ([name, text]) => `<tr><td>${escapeHtml(name)}</td><td>${escapeHtml(text)}</td></tr>`,
  );
  return `<table>${rows.join("")}</table>`;
}

function heatmapAxis(axis: Axis, edges: Value[], look: Look) {
  return {
    ...axisStyle(axis, look),
    name: axisTitle(axis),
    min: axis.min ?? edgeOf(edges, 0),
    max: axis.max ?? edgeOf(edges, edges.length - 1),
    splitLine: { show: false },
    ...edgeLabelOption(axis, edgeOf(edges, 0), edgeOf(edges, edges.length - 1), 5, look),
  };
}

export function heatmapOption(map: Heatmap, look: Look) {
  const { low, high } = heatmapScale(map);
  const xAxis = heatmapAxis(map.x, map.x_edges, look);
  const yAxis = heatmapAxis(map.y, map.y_edges, look);
  return {
    animation: false,
    textStyle: { fontFamily: kFontFamily },
    grid: {
      left: kPlotLeft,
      right: 92,
      top: kNameRow + 8,
      bottom: kHeatmapBottom,
      show: true,
      backgroundColor: look.blank,
      borderWidth: 0,
      outerBoundsMode: "none",
    },
    tooltip: {
      ...tooltipStyle(look),
      trigger: "item",
      formatter: (item: { value: CellValue }) => heatmapTip(map, item),
    },
    toolbox: zoomBrush({ xAxisIndex: 0, yAxisIndex: 0, filterMode: "none" }, look),
    dataZoom: ["xAxisIndex", "yAxisIndex"].map((axis) => ({
      type: "inside",
      [axis]: 0,
      filterMode: "none",
      zoomOnMouseWheel: "ctrl",
      moveOnMouseMove: "shift",
      moveOnMouseWheel: false,
    })),
    visualMap: {
      show: false,
      type: "continuous",
      dimension: 2,
      min: low,
      max: high,
      inRange: { color: heatmapColors(map, look) },
    },
    graphic: colorScale(heatmapColors(map, look), low, high, look),
    xAxis: { ...xAxis, nameLocation: "middle", nameGap: 30 },
    yAxis: {
      ...yAxis,
      nameLocation: "end",
      nameGap: 12,
      nameTextStyle: { ...yAxis.nameTextStyle, align: "left", padding: [0, 0, 0, -kPlotLeft] },
    },
    series: [heatmapSeries(map)],
  };
}

function heatmapColors(map: Heatmap, look: Look) {
  return map.diverging ? look.diverging : look.sequential;
}

/** About five round numbers from low to high. */
export function roundNumbers(low: number, high: number) {
  const rough = (high - low) / 5;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5].find((factor) => factor * power >= rough * 0.999) ?? 10);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, index) => (first + index) * step);
}

/** The colour scale at the right of the map, with round numbers beside it. */
function colorScale(colors: string[], low: number, high: number, look: Look) {
  const top = kNameRow + 8;
  const height = heatmapHeight() - top - kHeatmapBottom;
  const stops = colors.map((color, index) => ({ offset: 1 - index / (colors.length - 1), color }));
  const gradient = { type: "linear", x: 0, y: 0, x2: 0, y2: 1, colorStops: stops.reverse() };
  const ticks = roundNumbers(low, high).map((value) => {
    const y = (height * (high - value)) / (high - low);
    return {
      type: "group",
      children: [
        { type: "line", shape: { x1: 12, y1: y, x2: 17, y2: y }, style: { stroke: look.axis } },
        {
          type: "text",
          style: {
            text: formatSignificant(value, 3),
            x: 21,
            y,
            verticalAlign: "middle",
            fill: look.soft,
            font: `12px ${kFontFamily}`,
          },
        },
      ],
    };
  });
  const bar = { type: "rect", shape: { width: 12, height }, style: { fill: gradient } };
  const frame = { type: "rect", shape: { width: 70, height }, style: { fill: "transparent" } };
  return [{ id: "scale", type: "group", right: 0, top, silent: true, children: [frame, bar, ...ticks] }];
}

function heatmapSeries(map: Heatmap) {
  return {
    id: "cells",
    type: "custom",
    data: heatmapCells(map),
    encode: { x: 0, y: 1 },
    clip: true,
    progressive: false,
    renderItem: (_params: ItemParams, api: ItemApi) => {
      const [column, row] = [api.value(3), api.value(4)];
      const [left, bottom] = api.coord([edgeOf(map.x_edges, column), edgeOf(map.y_edges, row)]);
      const [right, top] = api.coord([edgeOf(map.x_edges, column + 1), edgeOf(map.y_edges, row + 1)]);
      // Whole pixels: no seams between neighbours.
      const x = Math.round(left);
      const y = Math.round(top);
      return {
        type: "rect",
        shape: { x, y, width: Math.round(right) - x, height: Math.round(bottom) - y },
        style: { fill: api.visual("color") },
      };
    },
  };
}

/** What the colours mean. */
export function scaleWords(map: Heatmap) {
  const empty = map.value.includes(null) ? "; empty cells: no value" : "";
  return `Colour: ${axisTitle(map.value_axis)}${empty}`;
}

export function heatmapCsv(map: Heatmap) {
  const head = [axisTitle(map.x), axisTitle(map.y), axisTitle(map.value_axis)];
  return csvText([head, ...heatmapCells(map).map((cell) => cell.slice(0, 3))]);
}

/** What the title does not say. */
export function heatmapWords(map: Heatmap) {
  return `Map of ${axisTitle(map.value_axis)} over ${axisTitle(map.x)} and ${axisTitle(map.y)}.`;
}

/** The ends of the map; all its cells are what is saved as CSV. */
export function heatmapNumbers(map: Heatmap) {
  const cells = heatmapCells(map).sort((a, b) => a[2] - b[2]);
  const row = (name: string, cell: CellValue) => [name, cell[2], cell[0], cell[1]];
  const [lowest, highest] = [cells[0], cells.at(-1)];
  const ends = lowest && highest ? [row("lowest", lowest), row("highest", highest)] : [];
  const axes = [map.value_axis, map.x, map.y].map(({ name, unit }) => column(name, unit));
  return { columns: [column(`Of ${cells.length} cells`, ""), ...axes], rows: ends };
}
