import { axisStyle, edgeLabelOption, tooltipStyle } from "./axes";
import { axisTip, itemTip, showsItems, type TipItem } from "./chart_tip";
import type { Axis, Chart, Value } from "./document";
import type { Extent } from "./figure_type";
import { axisTitle } from "./format";
import { itemAt } from "./lists";
import { eventRows, eventSeries, kEventRow, levelSeries, spanSeries } from "./marks";
import { kFontFamily, seriesColors, withOpacity, type Look } from "./palette";
import { drawable, drawnSeries } from "./series";

export const kPlotLeft = 68;

export const kNameRow = 24;

const kSliderRoom = 46;

/** Lowest and highest x of the charts' series and events; null when there is none. */
export function xExtent(charts: Chart[]) {
  let low = Infinity;
  let high = -Infinity;
  const include = (x: Value) => {
    if (x === null) return;
    low = Math.min(low, x);
    high = Math.max(high, x);
  };
  for (const chart of charts) {
    for (const series of chart.series) for (const x of series.x) include(drawable(x, chart.x));
    for (const event of chart.events) include(drawable(event.x, chart.x));
  }
  if (!(low < high)) return null;
  return charts.some((chart) => chart.x.log) ? { low, high } : snappedExtent(low, high);
}

/** A recording from 0 to 19.999 s is shown from 0 to 20 s; a logarithmic axis has no 0 to snap to. */
function snappedExtent(low: number, high: number) {
  const span = high - low;
  const grid = 10 ** Math.floor(Math.log10(span) - 0.7);
  const snap = (value: number, round: (value: number) => number) => {
    const snapped = Number((round(value / grid) * grid).toPrecision(12));
    return Math.abs(snapped - value) <= 0.004 * span ? snapped : value;
  };
  return { low: snap(low, Math.floor), high: snap(high, Math.ceil) };
}

export function xLabelCount(chart: Chart) {
  return chart.width === "half" ? 5 : 10;
}

function chartXAxis(chart: Chart, look: Look, extent: Extent | null) {
  const tight = chart.series.some((series) => series.kind !== "points");
  const low = chart.x.min ?? (extent && tight ? extent.low : null);
  const high = chart.x.max ?? (extent && tight ? extent.high : null);
  return {
    ...axisStyle(chart.x, look),
    name: axisTitle(chart.x),
    nameLocation: "middle",
    nameGap: 30,
    scale: true,
    min: low,
    max: high,
    splitNumber: xLabelCount(chart),
    ...edgeLabelOption(chart.x, low, high, xLabelCount(chart), look),
    splitLine: { show: !tight, lineStyle: { color: look.rule } },
  };
}

/** Values that are all positive and reach down towards zero stand on it. */
function fromZero({ min, max }: { min: number; max: number }) {
  return min >= 0 && min < 0.3 * max ? 0 : null;
}

function chartYAxis(axis: Axis, index: number, chart: Chart, look: Look, rows: number) {
  const bars = chart.series.some((each) => each.kind === "bars" && each.y_axis === index);
  const style = axisStyle(axis, look);
  return {
    ...style,
    name: axisTitle(axis),
    nameLocation: "end",
    nameGap: 12 + rows * kEventRow,
    nameTextStyle: {
      ...style.nameTextStyle,
      align: index === 0 ? "left" : "right",
      padding: index === 0 ? [0, 0, 0, -kPlotLeft] : [0, -kPlotLeft, 0, 0],
    },
    position: index === 0 ? "left" : "right",
    alignTicks: index === 1,
    scale: !bars,
    boundaryGap: axis.log ? undefined : bars ? [0, "6%"] : ["5%", "5%"],
    min: axis.min ?? (axis.log ? null : fromZero),
    max: axis.max,
    splitLine: { show: index === 0, lineStyle: { color: look.rule } },
  };
}

function chartZoom(chart: Chart, look: Look) {
  const shortest = Math.min(...chart.series.map((series) => series.x.length));
  // Filtering lets the y axis follow the zoom, but cuts lines between two far points.
  const filterMode = shortest >= 500 ? "filter" : "none";
  const zooms: object[] = [
    {
      type: "inside",
      xAxisIndex: 0,
      filterMode,
      zoomOnMouseWheel: "ctrl",
      moveOnMouseMove: "shift",
      moveOnMouseWheel: false,
    },
  ];
  if (chart.slider) {
    zooms.push({
      type: "slider",
      xAxisIndex: 0,
      filterMode,
      bottom: 8,
      height: 22,
      brushSelect: false,
      showDetail: false,
      borderColor: look.rule,
      backgroundColor: "transparent",
      fillerColor: withOpacity(look.axis, 0.22),
      handleStyle: { color: look.surface, borderColor: look.axis },
      moveHandleStyle: { color: look.axis, opacity: 0.5 },
      dataBackground: {
        lineStyle: { color: look.axis, opacity: 0.7, width: 0.8 },
        areaStyle: { color: look.axis, opacity: 0.15 },
      },
      selectedDataBackground: {
        lineStyle: { color: look.soft, width: 0.8 },
        areaStyle: { color: look.axis, opacity: 0.3 },
      },
    });
  }
  return { zooms, filterMode };
}

export function chartHeight(chart: Chart) {
  return (chart.width === "half" ? 320 : 380) + (chart.slider ? kSliderRoom : 0);
}

/**
 * ECharts' option for a chart drawn `width` pixels wide; `extent` is the x range to show,
 * isShown(name) tells whether the reader has not hidden that series.
 */
export function chartOption(chart: Chart, look: Look, width: number, extent: Extent | null, isShown: (name: string) => boolean) {
  const right = chart.y.length === 2 ? kPlotLeft : 26;
  const rows = eventRows(chart, extent, width - kPlotLeft - right);
  const bottom = 46 + (chart.slider ? kSliderRoom : 0);
  const colors = seriesColors(chart.series, look);
  const { zooms, filterMode } = chartZoom(chart, look);
  const byItem = showsItems(chart);
  const series: object[] = chart.series.map((each, i) => drawnSeries(each, i, itemAt(colors, i), chart));
  if (chart.spans.length > 0) series.push(spanSeries(chart, look));
  if (chart.events.length > 0) series.push(eventSeries(chart, look, rows));
  if (chart.levels.length > 0) series.push(levelSeries(chart.levels, look, false));
  return {
    animation: false,
    textStyle: { fontFamily: kFontFamily },
    grid: {
      left: kPlotLeft,
      right,
      top: kNameRow + 8 + rows * kEventRow,
      bottom,
      outerBoundsMode: "none",
    },
    legend: { show: false },
    tooltip: {
      ...tooltipStyle(look),
      trigger: byItem ? "item" : "axis",
      axisPointer: {
        type: "cross",
        lineStyle: { color: look.axis, type: "solid" },
        crossStyle: { color: look.axis, type: "solid" },
      },
      formatter: (hits: TipItem | { axisValue: number | string }[]) =>
        Array.isArray(hits)
          ? axisTip(chart, colors, Number(hits[0]?.axisValue), isShown)
          : itemTip(chart, colors, hits),
    },
    toolbox: zoomBrush({ xAxisIndex: 0, yAxisIndex: "none", filterMode }, look),
    dataZoom: zooms,
    xAxis: chartXAxis(chart, look, extent),
    yAxis: chart.y.map((axis, index) => chartYAxis(axis, index, chart, look, rows)),
    series,
  };
}

/** Dragging a range needs ECharts' toolbox; it stands outside the picture. */
export function zoomBrush(axes: object, look: Look) {
  return {
    left: -200,
    top: -200,
    itemSize: 1,
    showTitle: false,
    feature: {
      dataZoom: {
        ...axes,
        brushStyle: { color: withOpacity(look.axis, 0.22), borderColor: look.soft, borderWidth: 1 },
      },
    },
  };
}
