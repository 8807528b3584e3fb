import type { Level, SeriesKind, SeriesStyle, Tone } from "./document";

export const kFontFamily =
  'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif';

/** The colours of a page, light or dark. */
export interface Look {
  surface: string;
  ink: string;
  soft: string;
  rule: string;
  axis: string;
  blank: string;
  tip: string;
  levels: Record<Level, string>;
  tones: Record<Exclude<Tone, "auto">, string>;
  cycle: string[];
  sequential: string[];
  diverging: string[];
}

/* Okabe and Ito's palette and Tol's purple: told apart under every common colour blindness. */
export const kLightLook: Look = {
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

export const kDarkLook: Look = {
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

function toneColor(tone: Tone, look: Look): string | undefined {
  return tone === "auto" ? undefined : look.tones[tone];
}

/** One colour per series: its tone's, or for "auto" the next that no tone of the chart uses. */
export function seriesColors(series: SeriesStyle[], look: Look) {
  const taken = new Set(series.map((each) => toneColor(each.tone, look)));
  const free = look.cycle.filter((color) => !taken.has(color));
  let next = 0;
  return series.map((each) => toneColor(each.tone, look) ?? free[next++ % free.length] ?? look.ink);
}

export function withOpacity(color: string, opacity: number) {
  const channel = (start: number) => parseInt(color.slice(start, start + 2), 16);
  return `rgba(${channel(1)},${channel(3)},${channel(5)},${opacity})`;
}

export function isDashed(series: SeriesStyle) {
  return series.dashed || series.tone === "threshold";
}

/** The sample of a series beside its name: how it is drawn, small. */
export function swatch(series: SeriesStyle, color: string) {
  const shapes: Partial<Record<SeriesKind, string>> = {
    points: `<circle cx="12" cy="6" r="3.2" fill="${color}"/>`,
    band: `<rect x="1" y="1" width="22" height="10" fill="${color}" fill-opacity=".28"/>`,
    bars: `<rect x="4" y="1" width="16" height="10" fill="${color}" fill-opacity=".75"/>`,
  };
  const dash = isDashed(series) ? ' stroke-dasharray="5 3"' : "";
  const line = `<path d="M1 6H23" stroke="${color}" stroke-width="2.4" fill="none"${dash}/>`;
  return `<svg viewBox="0 0 24 12" aria-hidden="true">${shapes[series.kind] ?? line}</svg>`;
}
