const kLiveWindowS = 10;
const kLiveRow = 132;
const kLiveTop = 26;
const kLiveBottom = 22;
const kLiveGap = 26;
/** Above it two charts stand side by side. */
const kLiveWide = 900;

/**
 * What is drawn of the last seconds, a curve of each that is judged: points [t, value], gaps are null.
 * @typedef {{residual: [number, number | null][], threshold: [number, number | null][]}} LiveCurve
 */

/** @returns {LiveCurve[]} */
function emptyCurves(count) {
  return Array.from({ length: count }, () => ({ residual: [], threshold: [] }));
}

/** Appends the new steps of the server and lets go of what has left the window. */
function appendSteps(curves, steps, stepS) {
  curves.forEach((curve, of) => {
    steps.t_s.forEach((t, at) => {
      const last = curve.threshold.at(-1);
      if (last !== undefined && t - last[0] > 2.5 * stepS) {
        curve.residual.push([last[0] + stepS, null]);
        curve.threshold.push([last[0] + stepS, null]);
      }
      curve.residual.push([t, steps.low[of][at]], [t + stepS / 2, steps.high[of][at]]);
      curve.threshold.push([t, steps.threshold[of][at]]);
    });
    const newest = curve.threshold.at(-1)?.[0] ?? 0;
    for (const points of [curve.residual, curve.threshold]) {
      let old = 0;
      while (old < points.length && points[old][0] < newest - kLiveWindowS - 1) ++old;
      points.splice(0, old);
    }
  });
}

function liveColumns(host, count) {
  return count > 1 && host.clientWidth >= kLiveWide ? 2 : 1;
}

function liveHeight(host, count) {
  return Math.ceil(count / liveColumns(host, count)) * (kLiveRow + kLiveGap) + kLiveTop;
}

function liveGrid(at, columns) {
  const row = Math.floor(at / columns);
  const side = at % columns;
  const top = kLiveTop + row * (kLiveRow + kLiveGap);
  const grid = { top, height: kLiveRow - kLiveBottom, left: 62, right: 18 };
  if (columns === 1) return grid;
  return side === 0 ? { ...grid, right: "52%" } : { ...grid, left: "54%" };
}

function liveAxes(at, judged, look) {
  const quiet = { ...axisStyle({ log: false }, look), gridIndex: at, animation: false };
  const x = { ...quiet, min: 0, max: kLiveWindowS, splitNumber: 5, splitLine: { show: false } };
  x.axisLabel = { ...quiet.axisLabel, showMinLabel: false, showMaxLabel: false };
  const y = {
    ...quiet,
    min: 0,
    splitNumber: 3,
    name: `${judged.name} ${unitInBrackets(judged.unit)}`,
    nameLocation: "end",
    nameGap: 8,
    nameTextStyle: { ...quiet.nameTextStyle, align: "left", padding: [0, 0, 0, -50] },
  };
  return { x, y };
}

function liveSeries(at, look) {
  const common = { type: "line", showSymbol: false, silent: true, animation: false, xAxisIndex: at, yAxisIndex: at };
  return [
    { ...common, id: `r${at}`, name: "residual", lineStyle: { width: 1.4, color: look.tones.residual } },
    {
      ...common,
      id: `m${at}`,
      name: "threshold",
      lineStyle: { width: 1.6, type: "dashed", color: look.tones.threshold },
    },
  ];
}

/** Everything of the picture but its curves: once, and where width or colours have changed. */
function liveOption(host, judged) {
  const look = currentLook();
  const columns = liveColumns(host, judged.length);
  const axes = judged.map((each, at) => liveAxes(at, each, look));
  return {
    animation: false,
    backgroundColor: "transparent",
    textStyle: { fontFamily: kFontFamily },
    grid: judged.map((_, at) => liveGrid(at, columns)),
    xAxis: axes.map(({ x }) => x),
    yAxis: axes.map(({ y }) => y),
    series: judged.flatMap((_, at) => liveSeries(at, look)),
  };
}

/** The curves and the window that they stand in. */
function curveOption(curves, newest) {
  const max = Math.max(kLiveWindowS, newest);
  return {
    xAxis: curves.map(() => ({ min: max - kLiveWindowS, max })),
    series: curves.flatMap(({ residual, threshold }, at) => [
      { id: `r${at}`, data: residual },
      { id: `m${at}`, data: threshold },
    ]),
  };
}

/** A picture of all curves that is drawn anew as often as it is told. */
class LivePicture {
  constructor(host, judged) {
    this.host = host;
    this.judged = judged;
    this.chart = null;
    new ResizeObserver(() => this.begin()).observe(host);
    darkPreference.addEventListener("change", () => this.begin());
  }

  begin() {
    if (this.host.clientWidth === 0) return;
    this.host.style.height = `${liveHeight(this.host, this.judged.length)}px`;
    this.chart ??= echarts.init(this.host, null, { renderer: "canvas" });
    this.chart.resize();
    this.chart.setOption(liveOption(this.host, this.judged), { notMerge: true });
  }

  draw(curves, newest) {
    this.chart?.setOption(curveOption(curves, newest), { lazyUpdate: false, silent: true });
  }
}
