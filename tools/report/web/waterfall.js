const kWaterfallRow = 46;

function waterfallHeight(waterfall) {
  return waterfall.steps.length * kWaterfallRow + 76;
}

function waterfallLabelWidth(waterfall, width) {
  const widest = Math.max(...waterfall.steps.map((step) => textWidth(step.label, 13)));
  return Math.min(Math.ceil(widest) + 4, Math.round(width * 0.36));
}

/** What each step took away (positive) or added (negative); null for the first and at gaps. */
function waterfallFalls(steps) {
  return steps.map((step, index) => {
    const before = index === 0 ? null : steps[index - 1].value;
    return step.value === null || before === null ? null : before - step.value;
  });
}

function waterfallOption(waterfall, look, width) {
  const labels = waterfallLabelWidth(waterfall, width);
  const value = { ...axisStyle(waterfall.value_axis, look) };
  const series = [waterfallSeries(waterfall, look)];
  if (waterfall.levels.length > 0) series.push(levelSeries(waterfall.levels, look, true));
  return {
    animation: false,
    textStyle: { fontFamily: kFontFamily },
    grid: { left: labels + 22, right: 128, top: 24, bottom: 50, outerBoundsMode: "none" },
    tooltip: {
      ...tooltipStyle(look),
      trigger: "item",
      formatter: (item) => waterfallTip(waterfall, item.dataIndex),
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
        width: labels,
        overflow: "break",
        lineHeight: 16,
      },
    },
    series,
  };
}

function waterfallTip(waterfall, index) {
  const step = waterfall.steps[index];
  const fall = waterfallFalls(waterfall.steps)[index];
  const unit = waterfall.value_axis.unit;
  const rows = [[waterfall.value_axis.name, step.value]];
  if (fall !== null) rows.push([fall >= 0 ? "taken away" : "added", Math.abs(fall)]);
  const body = rows.map(([name, number]) => {
    const text = withUnit(formatNumber(number, waterfall.format), unit);
    return `<tr><td>${escapeHtml(name)}</td><td>${escapeHtml(text)}</td></tr>`;
  });
  return `<table><caption>${escapeHtml(step.label)}</caption>${body.join("")}</table>`;
}

function waterfallSeries(waterfall, look) {
  const falls = waterfallFalls(waterfall.steps);
  return {
    id: "steps",
    type: "custom",
    // The bar before is part of each step's extent: what was taken away is drawn up to it.
    data: waterfall.steps.map((step, index) => [index, step.value, 0]),
    dimensions: ["step", "value", "zero"],
    encode: { x: [1, 2], y: 0 },
    clip: false,
    renderItem: (params, api) => waterfallShapes(waterfall, falls, look, params, api),
  };
}

function waterfallShapes(waterfall, falls, look, params, api) {
  const index = params.dataIndex;
  const { value } = waterfall.steps[index];
  if (value === null) return null;
  const fall = falls[index];
  const [zero, middle] = api.coord([0, index]);
  const end = api.coord([value, index])[0];
  const half = 13;
  const bar = (from, to, style) => ({
    type: "rect",
    shape: { x: Math.min(from, to), y: middle - half, width: Math.abs(to - from), height: 2 * half },
    style,
  });
  const text = (content, x, align, style) => ({
    type: "text",
    silent: true,
    style: { text: content, x, y: middle, align, verticalAlign: "middle", ...style },
  });
  const last = index === waterfall.steps.length - 1;
  const solid = last ? look.tones.model : withOpacity(look.tones.model, 0.72);
  const children = [bar(zero, end, { fill: solid })];
  const shown = formatNumber(value, waterfall.format);
  let labelAt = end;
  if (fall !== null && fall !== 0) {
    const before = api.coord([value + fall, index])[0];
    const color = fall > 0 ? look.levels.good : look.levels.bad;
    const style = { fill: withOpacity(color, 0.13), stroke: color, lineWidth: 1, lineDash: [3, 3] };
    children.push(bar(end, before, style));
    children.push(connector(before, middle - half, look));
    labelAt = Math.max(end, before);
  }
  const change = fall === null ? "" : ` (${fall > 0 ? "-" : "+"}${formatChange(fall, waterfall)})`;
  const rich = {
    v: { fontWeight: 600, fontSize: 13, fill: look.ink, fontFamily: kFontFamily },
    c: { fontSize: 12, fill: look.soft, fontFamily: kFontFamily },
  };
  const content = `{v|${shown}}{c|${change}}`;
  const room = params.coordSys.x + params.coordSys.width + 124 - labelAt;
  const inside = textWidth(shown + change, 13) + 12 > room;
  children.push(
    inside
      ? text(content, labelAt - 8, "right", { rich, ...onBar(fall, look, rich) })
      : text(content, labelAt + 8, "left", { rich }),
  );
  return { type: "group", children };
}

/** A label that finds no room beside its bar stands on it: readable on the full colour, too. */
function onBar(fall, look, rich) {
  if (fall !== null && fall > 0) return {};
  const fill = look.surface;
  return { rich: { v: { ...rich.v, fill }, c: { ...rich.c, fill } } };
}

function formatChange(fall, waterfall) {
  return formatNumber(Math.abs(fall), waterfall.format);
}

/** Ties what was taken away to the end of the bar above. */
function connector(x, top, look) {
  return {
    type: "line",
    silent: true,
    shape: { x1: x, y1: top - (kWaterfallRow - 26), x2: x, y2: top },
    style: { stroke: look.soft, lineWidth: 1 },
  };
}

function waterfallCsv(waterfall) {
  const head = ["step", axisTitle(waterfall.value_axis)];
  return csvText([head, ...waterfall.steps.map((step) => [step.label, step.value])]);
}

function waterfallWords(waterfall) {
  const steps = waterfall.steps.map(
    (step) => `${step.label} ${formatNumber(step.value, waterfall.format)}`,
  );
  return `${waterfall.title}. ${axisTitle(waterfall.value_axis)} step by step: ${steps.join("; ")}.`;
}
