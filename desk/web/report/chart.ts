const kPlotLeft = 68;
const kNameRow = 24;
const kSliderRoom = 46;

/** Lowest and highest x of the charts' series and events; null when there is none. */
function xExtent(charts) {
  let low = Infinity;
  let high = -Infinity;
  const include = (x) => {
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
function snappedExtent(low, high) {
  const span = high - low;
  const grid = 10 ** Math.floor(Math.log10(span) - 0.7);
  const snap = (value, round) => {
    const snapped = Number((round(value / grid) * grid).toPrecision(12));
    return Math.abs(snapped - value) <= 0.004 * span ? snapped : value;
  };
  return { low: snap(low, Math.floor), high: snap(high, Math.ceil) };
}

function tipRow(series, color, value) {
  return `<tr><td>${swatch(series, color)}${escapeHtml(series.name)}</td><td>${value}</td></tr>`;
}

function tipValue(series, axis, at) {
  const number = (each) => formatSignificant(each, 5);
  const value = series.y[at];
  if (value === null) return "–";
  const text =
    series.kind === "band" ? `${number(value)} to ${number(series.y_upper[at])}` : number(value);
  return escapeHtml(withUnit(text, axis.unit));
}

/** Index of the point nearest to x (steps: of the last one at or before x); -1 beyond the ends. */
function pointAt(series, x) {
  const last = series.x.length - 1;
  if (series.x[0] === null || series.x[last] === null) return series.x.indexOf(x);
  const slack = (series.x[last] - series.x[0]) / 200;
  if (x < series.x[0] - slack || x > series.x[last] + slack) return -1;
  let [low, high] = [0, last];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (series.x[middle] <= x) low = middle;
    else high = middle;
  }
  if (series.x[high] <= x) return high;
  if (series.kind === "steps") return low;
  return x - series.x[low] <= series.x[high] - x ? low : high;
}

/** Points and bars show a tip each, lines one for all at an x. */
function showsItems(chart) {
  return chart.series.every((each) => each.kind === "points" || each.kind === "bars");
}

/** At one x the value of every shown series: their points need not share that x. */
function axisTip(chart, colors, x, isShown) {
  const rows = chart.series.flatMap((series, index) => {
    const at = series.kind === "points" || !isShown(series.name) ? -1 : pointAt(series, x);
    if (at < 0) return [];
    return [tipRow(series, colors[index], tipValue(series, chart.y[series.y_axis], at))];
  });
  for (const { from, to, label } of chart.spans) {
    if (x >= from && x <= to) rows.push(`<tr><td colspan="2">${escapeHtml(label)}</td></tr>`);
  }
  return tipTable(`${chart.x.name} ${withUnit(formatSignificant(x, 6), chart.x.unit)}`, rows);
}

function itemTip(chart, colors, item) {
  if (!/^s\d+$/.test(item.seriesId ?? "")) return "";
  const index = Number(item.seriesId.slice(1));
  const series = chart.series[index];
  const [x, at] = [series.x, item.dataIndex];
  const number = (each) => formatSignificant(each, 5);
  const place = series.kind === "bars" ? `${number(x[at])} to ${number(x[at + 1])}` : number(x[at]);
  const row = tipRow(series, colors[index], tipValue(series, chart.y[series.y_axis], at));
  return tipTable(`${chart.x.name} ${withUnit(place, chart.x.unit)}`, [row]);
}

function tipTable(caption, rows) {
  return `<table><caption>${escapeHtml(caption)}</caption>${rows.join("")}</table>`;
}

function xLabelCount(chart) {
  return chart.width === "half" ? 5 : 10;
}

function chartXAxis(chart, look, extent, bottom) {
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
function fromZero({ min, max }) {
  return min >= 0 && min < 0.3 * max ? 0 : null;
}

function chartYAxis(axis, index, chart, look, rows) {
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

function chartZoom(chart, look) {
  const shortest = Math.min(...chart.series.map((series) => series.x.length));
  // Filtering lets the y axis follow the zoom, but cuts lines between two far points.
  const filterMode = shortest >= 500 ? "filter" : "none";
  const zooms = [
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

function chartHeight(chart) {
  return (chart.width === "half" ? 320 : 380) + (chart.slider ? kSliderRoom : 0);
}

/**
 * ECharts' option for a chart drawn `width` pixels wide; `extent` is the x range to show,
 * isShown(name) tells whether the reader has not hidden that series.
 */
function chartOption(chart, look, width, extent, isShown) {
  const right = chart.y.length === 2 ? kPlotLeft : 26;
  const rows = eventRows(chart, extent, width - kPlotLeft - right);
  const bottom = 46 + (chart.slider ? kSliderRoom : 0);
  const colors = seriesColors(chart.series, look);
  const { zooms, filterMode } = chartZoom(chart, look);
  const byItem = showsItems(chart);
  const series = chart.series.map((each, i) => drawnSeries(each, i, colors[i], chart));
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
      formatter: (hits) =>
        byItem
          ? itemTip(chart, colors, hits)
          : axisTip(chart, colors, Number(hits[0].axisValue), isShown),
    },
    toolbox: zoomBrush({ xAxisIndex: 0, yAxisIndex: "none", filterMode }, look),
    dataZoom: zooms,
    xAxis: chartXAxis(chart, look, extent, bottom),
    yAxis: chart.y.map((axis, index) => chartYAxis(axis, index, chart, look, rows)),
    series,
  };
}

/** Dragging a range needs ECharts' toolbox; it stands outside the picture. */
function zoomBrush(axes, look) {
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

function chartCsv(chart) {
  const head = [];
  const columns = [];
  for (const series of chart.series) {
    const y = chart.y[series.y_axis];
    head.push(`${series.name}: ${axisTitle(chart.x)}`);
    columns.push(series.x);
    head.push(`${series.name}${series.kind === "band" ? " lower" : ""}: ${axisTitle(y)}`);
    columns.push(series.y);
    if (series.kind === "band") {
      head.push(`${series.name} upper: ${axisTitle(y)}`);
      columns.push(series.y_upper);
    }
  }
  const length = Math.max(...columns.map((column) => column.length));
  const rows = Array.from({ length }, (_, row) => columns.map((column) => column[row]));
  return csvText([head, ...rows]);
}

/** Each of a few spans, of many how often what comes. */
function spanWords({ spans, x }, at) {
  const kMostTold = 6;
  if (spans.length <= kMostTold) {
    return spans.map(({ from, to, label }) => `${label} from ${at(from, x)} to ${at(to, x)}`);
  }
  const counts = new Map();
  for (const { label } of spans) counts.set(label, (counts.get(label) ?? 0) + 1);
  return [...counts].map(([label, count]) => `${label}, ${count} times`);
}

/** What the title does not say. */
function chartWords(chart) {
  const ys = chart.y.map(axisTitle).join(" and ");
  const at = (value, axis) => withUnit(formatSignificant(value, 6), axis.unit);
  const events = chart.events.map((event) => `${event.label} at ${at(event.x, chart.x)}`);
  const levels = chart.levels.map((level) => `${level.label} at ${at(level.y, chart.y[0])}`);
  const spans = spanWords(chart, at);
  const marks = [...events, ...spans, ...levels];
  const marked = marks.length > 0 ? ` Marked: ${marks.join("; ")}.` : "";
  return `${ys} against ${axisTitle(chart.x)}.${marked}`;
}

/** The values themselves where they are few and stand at the same x, else the range of each series. */
function chartNumbers(chart) {
  const [first, ...others] = chart.series;
  const isLine = ({ kind }) => kind !== "bars" && kind !== "band";
  const alike = (other) => isLine(other) && other.x.join() === first.x.join();
  if (isLine(first) && first.x.length <= 30 && others.every(alike)) {
    const columns = chart.series.map(({ name, y_axis }) => column(name, chart.y[y_axis].unit));
    const rows = first.x.map((x, index) => [x, ...chart.series.map((series) => series.y[index])]);
    return { columns: [column(chart.x.name, chart.x.unit), ...columns], rows };
  }
  return {
    columns: ["Series", "Values drawn", "Lowest", "Highest"].map((name) => column(name, "")),
    rows: chart.series.map((series) => seriesRange(series, chart)),
  };
}

function column(name, unit) {
  return { name, unit, format: ".5g" };
}

function seriesRange(series, chart) {
  const number = (value, axis) => withUnit(formatSignificant(value, 5), axis.unit);
  const extreme = (values, isBeyond) => {
    let best = -1;
    values.forEach((value, index) => {
      if (value !== null && (best < 0 || isBeyond(value, values[best]))) best = index;
    });
    if (best < 0) return null;
    return `${number(values[best], chart.y[series.y_axis])} at ${number(series.x[best], chart.x)}`;
  };
  const count = series.y.filter((value) => value !== null).length;
  const highest = extreme(series.y_upper ?? series.y, (a, b) => a > b);
  return [series.name, count, extreme(series.y, (a, b) => a < b), highest];
}
