import type { Chart, EventMark, LevelMark } from "./document";
import type { ItemApi, ItemParams } from "./echarts";
import { penOf } from "./element";
import type { Extent } from "./figure_type";
import { itemAt } from "./lists";
import { kFontFamily, withOpacity, type Look } from "./palette";

export const kEventRow = 17;

/** How far an event's label may stand out of the plot on its right. */
const kBesidePlot = 16;

let measure: CanvasRenderingContext2D | null = null;

export function textWidth(text: string, fontSize: number) {
  const context = (measure ??= penOf(document.createElement("canvas")));
  context.font = `${fontSize}px ${kFontFamily}`;
  return context.measureText(text).width;
}

/**
 * Row of each event's label above the plot, and which side of its line it takes. From right to
 * left, each label lies higher than the labels and lines that it would touch.
 */
export function placeEventLabels(positions: number[], widths: number[], right: number) {
  const placed: { start: number; end: number; row: number }[] = [];
  const places = positions.map(() => ({ row: 0, flipped: false }));
  const labels = positions.map((x, index) => ({ x, index, width: widths[index] ?? 0 }));
  for (const { x, index, width } of labels.sort((a, b) => b.x - a.x)) {
    const flipped = x + width > right;
    const [start, end] = flipped ? [x - width, x] : [x, x + width];
    const touched = placed.filter((other) => other.end + 4 > start && other.start - 4 < end);
    const row = touched.reduce((highest, other) => Math.max(highest, other.row + 1), 0);
    placed.push({ start, end, row });
    places[index] = { row, flipped };
  }
  return { places, rows: Math.max(0, ...placed.map((each) => each.row + 1)) };
}

function eventWidths(events: EventMark[]) {
  return events.map((event) => textWidth(event.label, 12) + 10);
}

/** Rows that the event labels need over the whole x range on a plot of this width. */
export function eventRows(chart: Chart, extent: Extent | null, plotWidth: number) {
  if (chart.events.length === 0) return 0;
  if (extent === null) return 1;
  const scale = chart.x.log ? Math.log10 : (x: number) => x;
  const start = scale(extent.low);
  const perUnit = plotWidth / (scale(extent.high) - start);
  const positions = chart.events.map((event) => (scale(event.x) - start) * perUnit);
  return placeEventLabels(positions, eventWidths(chart.events), plotWidth + kBesidePlot).rows;
}

/** Vertical lines with their labels above the plot; the labels are placed anew at each zoom. */
export function eventSeries(chart: Chart, look: Look, rows: number) {
  const widths = eventWidths(chart.events);
  return {
    id: "events",
    type: "custom",
    data: chart.events.map((event) => [event.x]),
    dimensions: ["x"],
    encode: { x: 0, y: [] },
    tooltip: { show: false },
    silent: true,
    clip: false,
    z: 1,
    renderItem: (params: ItemParams, api: ItemApi) => {
      const plot = params.coordSys;
      const event = itemAt(chart.events, params.dataIndex);
      const positions = chart.events.map((each) => api.coord([each.x, 1])[0]);
      const x = itemAt(positions, params.dataIndex);
      if (!(x >= plot.x - 0.5 && x <= plot.x + plot.width + 0.5)) return null;
      const { places } = placeEventLabels(positions, widths, plot.x + plot.width + kBesidePlot);
      const place = itemAt(places, params.dataIndex);
      const color = look.levels[event.level];
      const top = plot.y - (Math.min(place.row, rows - 1) + 1) * kEventRow;
      return {
        type: "group",
        children: [
          {
            type: "line",
            shape: { x1: x, y1: top + 2, x2: x, y2: plot.y + plot.height },
            style: { stroke: color, lineWidth: 1.2 },
          },
          {
            type: "text",
            style: {
              text: event.label,
              x: place.flipped ? x - 5 : x + 5,
              y: top + kEventRow / 2,
              align: place.flipped ? "right" : "left",
              verticalAlign: "middle",
              fill: color,
              stroke: look.surface,
              lineWidth: 3,
              font: `12px ${kFontFamily}`,
            },
          },
        ],
      };
    },
  };
}

/** Bands behind the series; the label of one stands in it where there is room. */
export function spanSeries(chart: Chart, look: Look) {
  return {
    id: "spans",
    type: "custom",
    data: chart.spans.map(({ from, to }) => [from, to]),
    dimensions: ["from", "to"],
    encode: { x: [0, 1], y: [] },
    tooltip: { show: false },
    silent: true,
    clip: true,
    z: 0,
    renderItem: (params: ItemParams, api: ItemApi) => {
      const plot = params.coordSys;
      const { from, to, label, level } = itemAt(chart.spans, params.dataIndex);
      const left = Math.max(api.coord([from ?? NaN, 0])[0], plot.x);
      const right = Math.min(api.coord([to ?? NaN, 0])[0], plot.x + plot.width);
      if (!(right > left)) return null;
      const color = look.levels[level];
      const shape = { x: left, y: plot.y, width: Math.max(right - left, 1), height: plot.height };
      const children: object[] = [{ type: "rect", shape, style: { fill: withOpacity(color, 0.13) } }];
      if (textWidth(label, 12) + 10 < right - left) {
        const style = { text: label, x: left + 5, y: plot.y + plot.height - 5, verticalAlign: "bottom" };
        children.push({ type: "text", style: { ...style, fill: color, font: `12px ${kFontFamily}` } });
      }
      return { type: "group", children };
    },
  };
}

/** A label that would leave the plot stands beside its line. */
function alongAlign(at: number, half: number, left: number, right: number) {
  if (at + half > right) return "right";
  return at - half < left ? "left" : "center";
}

/** Horizontal lines (vertical where the value axis lies) with their label at the far end. */
export function levelSeries(levels: LevelMark[], look: Look, alongX: boolean) {
  return {
    id: "levels",
    type: "custom",
    data: levels.map((level) => [level.y]),
    dimensions: ["level"],
    encode: alongX ? { x: 0, y: [] } : { x: [], y: 0 },
    tooltip: { show: false },
    silent: true,
    clip: false,
    z: 4,
    renderItem: (params: ItemParams, api: ItemApi) => {
      const plot = params.coordSys;
      const { y, label } = itemAt(levels, params.dataIndex);
      const at = alongX ? api.coord([y, 0])[0] : api.coord([plot.x, y])[1];
      const start = alongX ? plot.x : plot.y;
      if (!(at >= start && at <= start + (alongX ? plot.width : plot.height))) return null;
      const right = plot.x + plot.width;
      const shape = alongX
        ? { x1: at, y1: plot.y, x2: at, y2: plot.y + plot.height }
        : { x1: plot.x, y1: at, x2: right, y2: at };
      // Below the line where there is no room above it, or most of what is drawn.
      const under = at - plot.y < 18 || (at > plot.y + 0.75 * plot.height && at < plot.y + plot.height - 20);
      const place = alongX
        ? { x: at, y: plot.y - 5, align: alongAlign(at, textWidth(label, 12) / 2, plot.x, right) }
        : { x: right - 4, y: under ? at + 17 : at - 4, align: "right" };
      const style = {
        text: label,
        ...place,
        verticalAlign: "bottom",
        fill: look.soft,
        stroke: look.surface,
        lineWidth: 3,
        font: `12px ${kFontFamily}`,
      };
      return {
        type: "group",
        children: [
          { type: "line", shape, style: { stroke: look.soft, lineWidth: 1.2, lineDash: [2, 3] } },
          { type: "text", style },
        ],
      };
    },
  };
}
