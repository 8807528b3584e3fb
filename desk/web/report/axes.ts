import type { Axis, Value } from "./document";
import { formatSignificant, formatTick } from "./format";
import { kFontFamily, type Look } from "./palette";

export function tooltipStyle(look: Look) {
  return {
    confine: true,
    transitionDuration: 0,
    backgroundColor: look.tip,
    borderColor: look.axis,
    borderWidth: 1,
    padding: [7, 10],
    className: "tip",
    textStyle: { color: look.ink, fontSize: 12.5, fontFamily: kFontFamily },
    extraCssText: "box-shadow:0 2px 10px rgba(0,0,0,.14);border-radius:5px",
  };
}

function axisLabelStyle(look: Look) {
  return { color: look.soft, fontSize: 12, hideOverlap: true, formatter: formatTick };
}

/** ECharts' distance between the labels of an axis cut into about `count` parts. */
export function labelStep(span: number, count: number) {
  const rough = span / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const mantissa = rough / power;
  const round = mantissa < 1.5 ? 1 : mantissa < 2.5 ? 2 : mantissa < 4 ? 3 : mantissa < 7 ? 5 : 10;
  return round * power;
}

/** The ends of an axis are labelled only where they fall in with the other labels. */
export function edgeLabels(low: number, high: number, count: number, log: boolean) {
  const isPower = (value: number) => Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-6;
  if (log) return { showMinLabel: isPower(low), showMaxLabel: isPower(high) };
  const step = labelStep(high - low, count);
  const regular = (value: number) => Math.abs(value / step - Math.round(value / step)) < 1e-6;
  return { showMinLabel: regular(low), showMaxLabel: regular(high) };
}

/** The same as the part of an axis' option that says so. */
export function edgeLabelOption(axis: Axis, low: Value, high: Value, count: number, look: Look) {
  if (low === null || high === null) return {};
  return { axisLabel: { ...axisLabelStyle(look), ...edgeLabels(low, high, count, axis.log) } };
}

/** What all numeric axes have in common. */
export function axisStyle(axis: Axis, look: Look) {
  return {
    type: axis.log ? "log" : "value",
    axisLine: { show: true, onZero: false, lineStyle: { color: look.axis } },
    axisTick: { show: true, lineStyle: { color: look.axis } },
    axisLabel: axisLabelStyle(look),
    splitLine: { show: true, lineStyle: { color: look.rule, width: 1 } },
    minorTick: { show: axis.log },
    nameTextStyle: { color: look.ink, fontSize: 12.5, fontFamily: kFontFamily },
    axisPointer: {
      label: {
        backgroundColor: look.soft,
        color: look.surface,
        formatter: ({ value }: { value: number | string }) => formatSignificant(Number(value), 4),
      },
    },
  };
}
