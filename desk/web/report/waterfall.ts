import { axisStyle, tooltipStyle } from "./axes";
import { column } from "./chart_words";
import type { Value, Waterfall, WaterfallStep } from "./document";
import type { ItemApi, ItemParams } from "./echarts";
import { axisTitle, csvText, escapeHtml, formatNumber, withUnit } from "./format";
import { itemAt } from "./lists";
import { levelSeries, textWidth } from "./marks";
import { kFontFamily, withOpacity, type Look } from "./palette";

const kWaterfallRow = 46;

/** In a narrower picture each label stands above its bar, which is thinner. */
const kWaterfallNarrow = 480;

/** Half of a bar's thickness, and how far below the middle of its row it lies. */
interface BarSize {
  half: number;
  below: number;
}

function waterfallBar(width: number) {
  return width < kWaterfallNarrow ? { half: 9, below: 11 } : { half: 13, below: 0 };
}

export function waterfallHeight(waterfall: Waterfall) {
  return waterfall.steps.length * kWaterfallRow + 76;
}

function waterfallLabelWidth(waterfall: Waterfall, width: number) {
  const widest = Math.max(...waterfall.steps.map((step) => textWidth(step.label, 13)));
  return Math.min(Math.ceil(widest) + 4, Math.round(width * 0.36));
}

/** What each step took away (positive) or added (negative); null for the first and at gaps. */
export function waterfallFalls(steps: WaterfallStep[]) {
  return steps.map((step, index) => {
    const before = steps[index - 1]?.value ?? null;
    return step.value === null || before === null ? null : before - step.value;
  });
}

export function waterfallOption(waterfall: Waterfall, look: Look, width: number) {
  const narrow = width < kWaterfallNarrow;
  const labels = waterfallLabelWidth(waterfall, width);
  const value = { ...axisStyle(waterfall.value_axis, look) };
  const series: object[] = [waterfallSeries(waterfall, look, waterfallBar(width))];
  if (waterfall.levels.length > 0) series.push(levelSeries(waterfall.levels, look, true));
  return {
    animation: false,
    textStyle: { fontFamily: kFontFamily },
    grid: {
      left: narrow ? 8 : labels + 22,
      right: stepWordsRoom(waterfall),
      top: 24,
      bottom: 50,
      outerBoundsMode: "none",
    },
    tooltip: {
      ...tooltipStyle(look),
      trigger: "item",
      formatter: (item: { dataIndex: number }) => waterfallTip(waterfall, item.dataIndex),
    },
    xAxis: {
      ...value,
      name: axisTitle(waterfall.value_axis),
      nameLocation: "middle",
      nameGap: 30,
      min: waterfall.value_axis.min,
      max: waterfall.value_axis.max,
    },
    yAxis: {
      type: "category",
      inverse: true,
      data: waterfall.steps.map((step) => step.label),
      axisLine: { lineStyle: { color: look.axis } },
      axisTick: { show: false },
      axisLabel: {
        color: look.ink,
        fontSize: 13,
        interval: 0,
        lineHeight: 16,
        // Each key in both cases: an option is merged into the one before it.
        inside: narrow,
        margin: narrow ? 4 : 8,
        verticalAlign: narrow ? "bottom" : "middle",
        padding: narrow ? [0, 0, 1, 0] : 0,
        width: narrow ? null : labels,
        overflow: narrow ? "none" : "break",
      },
    },
    series,
  };
}

function waterfallTip(waterfall: Waterfall, index: number) {
  const step = itemAt(waterfall.steps, index);
  const fall = itemAt(waterfallFalls(waterfall.steps), index);
  const unit = waterfall.value_axis.unit;
  const rows: [string, Value][] = [[waterfall.value_axis.name, step.value]];
  if (fall !== null) rows.push([fall >= 0 ? "taken away" : "added", Math.abs(fall)]);
  const body = rows.map(([name, number]) => {
    const text = withUnit(formatNumber(number, waterfall.format), unit);
    return `<tr><td>${escapeHtml(name)}</td><td>${escapeHtml(text)}</td></tr>`;
  });
  return `<table><caption>${escapeHtml(step.label)}</caption>${body.join("")}</table>`;
}

function waterfallSeries(waterfall: Waterfall, look: Look, thickness: BarSize) {
  const falls = waterfallFalls(waterfall.steps);
  return {
    id: "steps",
    type: "custom",
    // The bar before is part of each step's extent: what was taken away is drawn up to it.
    data: waterfall.steps.map((step, index) => [index, step.value, 0]),
    dimensions: ["step", "value", "zero"],
    encode: { x: [1, 2], y: 0 },
    clip: false,
    renderItem: (params: ItemParams, api: ItemApi) => waterfallShapes(waterfall, falls, look, thickness, params, api),
  };
}

function waterfallShapes(waterfall: Waterfall, falls: Value[], look: Look, { half, below }: BarSize, params: ItemParams, api: ItemApi) {
  const index = params.dataIndex;
  const { value } = itemAt(waterfall.steps, index);
  if (value === null) return null;
  const fall = itemAt(falls, index);
  const [zero, center] = api.coord([0, index]);
  const middle = center + below;
  const end = api.coord([value, index])[0];
  const bar = (from: number, to: number, style: object) => ({
    type: "rect",
    shape: { x: Math.min(from, to), y: middle - half, width: Math.abs(to - from), height: 2 * half },
    style,
  });
  const text = (content: string, x: number, align: string, style: object) => ({
    type: "text",
    silent: true,
    style: { text: content, x, y: middle, align, verticalAlign: "middle", ...style },
  });
  const last = index === waterfall.steps.length - 1;
  const solid = last ? look.tones.model : withOpacity(look.tones.model, 0.72);
  const children: object[] = [bar(zero, end, { fill: solid })];
  let labelAt = end;
  if (fall !== null && fall !== 0) {
    const before = api.coord([value + fall, index])[0];
    const color = fall > 0 ? look.levels.good : look.levels.bad;
    const style = { fill: withOpacity(color, 0.13), stroke: color, lineWidth: 1, lineDash: [3, 3] };
    children.push(bar(end, before, style));
    if (below === 0) children.push(connector(before, middle - half, look));
    labelAt = Math.max(end, before);
  }
  const [shown, change] = stepWords(waterfall, falls, index);
  const rich = {
    v: { fontWeight: 600, fontSize: 13, fill: look.ink, fontFamily: kFontFamily },
    c: { fontSize: 12, fill: look.soft, fontFamily: kFontFamily },
  };
  const content = `{v|${shown}}{c|${change}}`;
  children.push(text(content, labelAt + 8, "left", { rich }));
  return { type: "group", children };
}

/** What stands beside a bar: its value, and what the step changed. */
function stepWords({ steps, format }: Waterfall, falls: Value[], index: number) {
  const fall = falls[index] ?? null;
  const shown = formatNumber(steps[index]?.value ?? null, format);
  if (fall === null) return [shown, ""];
  return [shown, ` (${fall > 0 ? "-" : "+"}${formatNumber(Math.abs(fall), format)})`];
}

/** Room for the widest of these words beside the longest bar: on a bar they could not be read. */
function stepWordsRoom(waterfall: Waterfall) {
  const falls = waterfallFalls(waterfall.steps);
  const widths = waterfall.steps.map((_, index) =>
    textWidth(stepWords(waterfall, falls, index).join(""), 14),
  );
  return Math.ceil(Math.max(...widths)) + 12;
}

/** Ties what was taken away to the end of the bar above. */
function connector(x: number, top: number, look: Look) {
  return {
    type: "line",
    silent: true,
    shape: { x1: x, y1: top - (kWaterfallRow - 26), x2: x, y2: top },
    style: { stroke: look.soft, lineWidth: 1 },
  };
}

export function waterfallCsv(waterfall: Waterfall) {
  const head = ["step", axisTitle(waterfall.value_axis)];
  return csvText([head, ...waterfall.steps.map((step) => [step.label, step.value])]);
}

/** What the title does not say. */
export function waterfallWords(waterfall: Waterfall) {
  const { steps, value_axis, format } = waterfall;
  const name = (step: WaterfallStep) => `${step.label} ${formatNumber(step.value, format)}`;
  const words = steps.length > 1 ? `${steps.length} steps, from ${name(itemAt(steps, 0))} to ${name(itemAt(steps, steps.length - 1))}` : steps.map(name).join();
  return `${axisTitle(value_axis)} step by step: ${words}.`;
}

export function waterfallNumbers({ steps, value_axis, format }: Waterfall) {
  const falls = waterfallFalls(steps);
  return {
    columns: [
      column("Step", ""),
      { name: value_axis.name, unit: value_axis.unit, format },
      { name: "Change", unit: value_axis.unit, format },
    ],
    rows: steps.map((step, index) => {
      const fall = itemAt(falls, index);
      return [step.label, step.value, fall === null ? null : -fall];
    }),
  };
}
