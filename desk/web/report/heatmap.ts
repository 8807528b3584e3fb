const kHeatmapBottom = 46;

function heatmapHeight() {
  return 360;
}

function heatmapCells(map) {
  const columns = map.x_edges.length - 1;
  return map.value.flatMap((value, index) => {
    if (value === null) return [];
    const column = index % columns;
    const row = Math.floor(index / columns);
    const middle = (edges, at) => (edges[at] + edges[at + 1]) / 2;
    return [[middle(map.x_edges, column), middle(map.y_edges, row), value, column, row]];
  });
}

function heatmapScale(map) {
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

function heatmapTip(map, item) {
  const [, , value, column, row] = item.value;
  const range = (edges, at, unit) =>
    withUnit(`${formatSignificant(edges[at], 5)} to ${formatSignificant(edges[at + 1], 5)}`, unit);
  const lines = [
    [map.x.name, range(map.x_edges, column, map.x.unit)],
    [map.y.name, range(map.y_edges, row, map.y.unit)],
    [map.value_axis.name, withUnit(formatSignificant(value, 5), map.value_axis.unit)],
  ];
  const rows = lines.map(
    ([name, text]) => `<tr><td>${escapeHtml(name)}</td><td>${escapeHtml(text)}</td></tr>`,
  );
  return `<table>${rows.join("")}</table>`;
}

function heatmapAxis(axis, edges, look) {
  return {
    ...axisStyle(axis, look),
    name: axisTitle(axis),
    min: axis.min ?? edges[0],
    max: axis.max ?? edges[edges.length - 1],
    splitLine: { show: false },
    ...edgeLabelOption(axis, edges[0], edges[edges.length - 1], 5, look),
  };
}

function heatmapOption(map, look) {
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
      formatter: (item) => heatmapTip(map, item),
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

function heatmapColors(map, look) {
  return map.diverging ? look.diverging : look.sequential;
}

/** About five round numbers from low to high. */
function roundNumbers(low, high) {
  const rough = (high - low) / 5;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, index) => (first + index) * step);
}

/** The colour scale at the right of the map, with round numbers beside it. */
function colorScale(colors, low, high, look) {
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

function heatmapSeries(map) {
  return {
    id: "cells",
    type: "custom",
    data: heatmapCells(map),
    encode: { x: 0, y: 1 },
    clip: true,
    progressive: false,
    renderItem: (params, api) => {
      const [column, row] = [api.value(3), api.value(4)];
      const [left, bottom] = api.coord([map.x_edges[column], map.y_edges[row]]);
      const [right, top] = api.coord([map.x_edges[column + 1], map.y_edges[row + 1]]);
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
function scaleWords(map) {
  const empty = map.value.includes(null) ? "; empty cells: no value" : "";
  return `Colour: ${axisTitle(map.value_axis)}${empty}`;
}

function heatmapCsv(map) {
  const head = [axisTitle(map.x), axisTitle(map.y), axisTitle(map.value_axis)];
  return csvText([head, ...heatmapCells(map).map((cell) => cell.slice(0, 3))]);
}

/** What the title does not say. */
function heatmapWords(map) {
  return `Map of ${axisTitle(map.value_axis)} over ${axisTitle(map.x)} and ${axisTitle(map.y)}.`;
}

/** The ends of the map; all its cells are what is saved as CSV. */
function heatmapNumbers(map) {
  const cells = heatmapCells(map).sort((a, b) => a[2] - b[2]);
  const row = (name, cell) => [name, cell[2], cell[0], cell[1]];
  const ends = cells.length > 0 ? [row("lowest", cells[0]), row("highest", cells.at(-1))] : [];
  const axes = [map.value_axis, map.x, map.y].map(({ name, unit }) => column(name, unit));
  return { columns: [column(`Of ${cells.length} cells`, ""), ...axes], rows: ends };
}
