const kFontFamily =
  'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif';

/* Okabe and Ito's palette and Tol's purple: told apart under every common colour blindness. */
const kLightLook = {
  surface: "#ffffff",
  ink: "#17202a",
  soft: "#52606d",
  rule: "#e4e8ec",
  axis: "#7d8995",
  blank: "#dde1e6",
  tip: "rgba(255,255,255,0.97)",
  levels: { good: "#00734f", warn: "#9a5b00", bad: "#b3261e", neutral: "#44576a" },
  tones: {
    measured: "#26323f",
    model: "#0072b2",
    residual: "#d55e00",
    threshold: "#aa3377",
    faint: "#7f8a96",
  },
  cycle: ["#0072b2", "#d55e00", "#009e73", "#aa3377", "#a07c00", "#2f93cc", "#6b5b95"],
  sequential: ["#f4fac4", "#c7e9b4", "#7fcdbb", "#41b6c4", "#1d91c0", "#225ea8", "#0c2c84"],
  diverging: ["#0b4f8a", "#4f93c4", "#a9cde4", "#f5f5f3", "#f4bf96", "#d97a33", "#8f3d00"],
};
const kDarkLook = {
  surface: "#191f26",
  ink: "#e6eaee",
  soft: "#a0acb8",
  rule: "#29313a",
  axis: "#707c88",
  blank: "#0d1115",
  tip: "rgba(30,37,45,0.97)",
  levels: { good: "#4bc99b", warn: "#e9b04f", bad: "#ff8f80", neutral: "#a9b8c6" },
  tones: {
    measured: "#dfe5ea",
    model: "#4aa8ea",
    residual: "#ff9457",
    threshold: "#e38bc0",
    faint: "#75818d",
  },
  cycle: ["#4aa8ea", "#ff9457", "#3ccb9b", "#e38bc0", "#e3c14b", "#a9b8ff", "#c9a58a"],
  sequential: ["#2a3b9c", "#225ea8", "#1d91c0", "#41b6c4", "#7fcdbb", "#c7e9b4", "#f4fac4"],
  diverging: ["#8cc8f2", "#4a90c4", "#2f6086", "#444c55", "#8d552c", "#d97f3a", "#ffc18f"],
};

const darkPreference = window.matchMedia("(prefers-color-scheme: dark)");

function currentLook() {
  const printing = document.documentElement.hasAttribute("data-print");
  return darkPreference.matches && !printing ? kDarkLook : kLightLook;
}

/** One colour per series: its tone's, or for "auto" the next that no tone of the chart uses. */
function seriesColors(series, look) {
  const taken = new Set(series.map((each) => look.tones[each.tone]));
  const free = look.cycle.filter((color) => !taken.has(color));
  let next = 0;
  return series.map((each) => look.tones[each.tone] ?? free[next++ % free.length]);
}

function withOpacity(color, opacity) {
  const channel = (start) => parseInt(color.slice(start, start + 2), 16);
  return `rgba(${channel(1)},${channel(3)},${channel(5)},${opacity})`;
}

function isDashed(series) {
  return series.dashed || series.tone === "threshold";
}

/** The sample of a series beside its name: how it is drawn, small. */
function swatch(series, color) {
  const shapes = {
    points: `<circle cx="12" cy="6" r="3.2" fill="${color}"/>`,
    band: `<rect x="1" y="1" width="22" height="10" fill="${color}" fill-opacity=".28"/>`,
    bars: `<rect x="4" y="1" width="16" height="10" fill="${color}" fill-opacity=".75"/>`,
  };
  const dash = isDashed(series) ? ' stroke-dasharray="5 3"' : "";
  const line = `<path d="M1 6H23" stroke="${color}" stroke-width="2.4" fill="none"${dash}/>`;
  return `<svg viewBox="0 0 24 12" aria-hidden="true">${shapes[series.kind] ?? line}</svg>`;
}

function tooltipStyle(look) {
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

function axisLabelStyle(look) {
  return { color: look.soft, fontSize: 12, hideOverlap: true, formatter: formatTick };
}

/** ECharts' distance between the labels of an axis cut into about `count` parts. */
function labelStep(span, count) {
  const rough = span / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const mantissa = rough / power;
  const round = mantissa < 1.5 ? 1 : mantissa < 2.5 ? 2 : mantissa < 4 ? 3 : mantissa < 7 ? 5 : 10;
  return round * power;
}

/** The ends of an axis are labelled only where they fall in with the other labels. */
function edgeLabels(low, high, count, log) {
  const isPower = (value) => Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-6;
  if (log) return { showMinLabel: isPower(low), showMaxLabel: isPower(high) };
  const step = labelStep(high - low, count);
  const regular = (value) => Math.abs(value / step - Math.round(value / step)) < 1e-6;
  return { showMinLabel: regular(low), showMaxLabel: regular(high) };
}

/** The same as the part of an axis' option that says so. */
function edgeLabelOption(axis, low, high, count, look) {
  if (low === null || high === null) return {};
  return { axisLabel: { ...axisLabelStyle(look), ...edgeLabels(low, high, count, axis.log) } };
}

/** What all numeric axes have in common. */
function axisStyle(axis, look) {
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
        formatter: ({ value }) => formatSignificant(Number(value), 4),
      },
    },
  };
}
