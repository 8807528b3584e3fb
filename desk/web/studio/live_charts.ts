import { labelStep } from "../report/axes";
import { element, penOf } from "../report/element";
import { formatTick, unitInBrackets } from "../report/format";
import { itemAt } from "../report/lists";
import { currentLook, darkPreference } from "../report/look";
import { kFontFamily, type Look } from "../report/palette";
import type { LiveSteps } from "./api";
import type { TimeRange } from "./charts";

const kLiveWindowS = 10;

const kLiveRow = 132;

const kLiveTop = 26;

const kLiveBottom = 22;

const kLiveGap = 26;

const kLiveLeft = 62;

const kLiveRight = 18;

/** Above it two charts stand side by side. */
const kLiveWide = 900;

/** s, and the value there; a gap is null. */
type Point = [number, number | null];

/** What is drawn of the last seconds, of one that is judged. */
export interface LiveCurve {
  residual: Point[];
  threshold: Point[];
}

/** Where a chart's curves stand, in pixels of the page. */
interface Plot {
  left: number;
  top: number;
  width: number;
  height: number;
}

/** The end of an axis that begins at 0, and the step between its labels. */
interface Scale {
  top: number;
  step: number;
}

export function emptyCurves(count: number): LiveCurve[] {
  return Array.from({ length: count }, () => ({ residual: [], threshold: [] }));
}

/** Appends the new steps of the server and lets go of what has left the window. */
export function appendSteps(curves: LiveCurve[], steps: LiveSteps, stepS: number) {
  curves.forEach((curve, of) => {
    const low = itemAt(steps.low, of);
    const high = itemAt(steps.high, of);
    const threshold = itemAt(steps.threshold, of);
    steps.t_s.forEach((t, at) => {
      if (t === null) return;
      const last = curve.threshold.at(-1);
      if (last !== undefined && t - last[0] > 2.5 * stepS) {
        curve.residual.push([last[0] + stepS, null]);
        curve.threshold.push([last[0] + stepS, null]);
      }
      curve.residual.push([t, low[at] ?? null], [t + stepS / 2, high[at] ?? null]);
      curve.threshold.push([t, threshold[at] ?? null]);
    });
    const newest = curve.threshold.at(-1)?.[0] ?? 0;
    for (const points of [curve.residual, curve.threshold]) {
      const first = points.findIndex(([t]) => t >= newest - kLiveWindowS - 1);
      points.splice(0, first < 0 ? points.length : first);
    }
  });
}

function liveColumns(host: HTMLElement, count: number) {
  return count > 1 && host.clientWidth >= kLiveWide ? 2 : 1;
}

function liveHeight(host: HTMLElement, count: number) {
  return Math.ceil(count / liveColumns(host, count)) * (kLiveRow + kLiveGap) + kLiveTop;
}

/** Where a chart's curves stand, in pixels of the page. */
function livePlot(at: number, columns: number, width: number): Plot {
  const room = width / columns;
  const left = (at % columns) * room + kLiveLeft;
  const top = kLiveTop + Math.floor(at / columns) * (kLiveRow + kLiveGap);
  return { left, top, width: room - kLiveLeft - kLiveRight, height: kLiveRow - kLiveBottom };
}

/** The end of the axis of what is never negative, and the step between its labels. */
export function liveScale(curve: LiveCurve): Scale {
  let most = 0;
  for (const points of [curve.residual, curve.threshold]) {
    for (const [, value] of points) if (value !== null && value > most) most = value;
  }
  const step = labelStep(most > 0 ? 1.05 * most : 1, 3);
  return { step, top: step * Math.ceil((1.05 * most) / step || 1) };
}

function drawLiveAxes(pen: CanvasRenderingContext2D, plot: Plot, scale: Scale, window: TimeRange, look: Look) {
  pen.font = `12px ${kFontFamily}`;
  pen.fillStyle = look.soft;
  pen.textBaseline = "middle";
  pen.textAlign = "right";
  pen.lineWidth = 1;
  for (let value = 0; value <= scale.top * 1.0001; value += scale.step) {
    const y = Math.round(plot.top + plot.height * (1 - value / scale.top)) + 0.5;
    pen.strokeStyle = value === 0 ? look.axis : look.rule;
    pen.beginPath();
    pen.moveTo(plot.left, y);
    pen.lineTo(plot.left + plot.width, y);
    pen.stroke();
    pen.fillText(formatTick(Number(value.toPrecision(6))), plot.left - 8, y);
  }
  pen.textBaseline = "top";
  pen.textAlign = "center";
  const kStepS = 2;
  for (let t = kStepS * Math.ceil(window.from / kStepS); t <= window.to; t += kStepS) {
    const x = plot.left + (plot.width * (t - window.from)) / kLiveWindowS;
    pen.fillText(`${t}${t + kStepS > window.to ? " s" : ""}`, x, plot.top + plot.height + 6);
  }
}

function drawLiveCurve(pen: CanvasRenderingContext2D, plot: Plot, points: Point[], scale: Scale, window: TimeRange) {
  const perS = plot.width / kLiveWindowS;
  const perUnit = plot.height / scale.top;
  let isDown = false;
  pen.beginPath();
  for (const [t, value] of points) {
    if (value === null) {
      isDown = false;
      continue;
    }
    const x = plot.left + (t - window.from) * perS;
    const y = plot.top + plot.height - value * perUnit;
    if (isDown) pen.lineTo(x, y);
    else pen.moveTo(x, y);
    isDown = true;
  }
  pen.stroke();
}

/**
 * All curves in one picture, drawn anew as often as it is told. Not by ECharts: that takes ten times as long, and
 * thirty times a second there is no time for it.
 */
export class LivePicture {
  private readonly canvas = element("canvas", { "aria-hidden": "true" });
  private readonly pen = penOf(this.canvas, { willReadFrequently: true });
  private last: [LiveCurve[], number] | null = null;
  private width = 0;
  private height = 0;

  constructor(
    private readonly host: HTMLElement,
    private readonly judged: { name: string; unit: string }[],
  ) {
    host.append(this.canvas);
    new ResizeObserver(() => this.begin()).observe(host);
    darkPreference.addEventListener("change", () => this.begin());
  }

  /** Takes the size of its place. */
  begin() {
    const ratio = window.devicePixelRatio || 1;
    this.width = this.host.clientWidth;
    this.height = liveHeight(this.host, this.judged.length);
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    this.canvas.style.width = `${this.width}px`;
    this.canvas.style.height = `${this.height}px`;
    this.pen.scale(ratio, ratio);
    if (this.last !== null) this.draw(...this.last);
  }

  /** `newest`: the right end of the picture, s. */
  draw(curves: LiveCurve[], newest: number) {
    this.last = [curves, newest];
    const { pen } = this;
    const look = currentLook();
    const to = Math.max(kLiveWindowS, newest);
    const span = { from: to - kLiveWindowS, to };
    const columns = liveColumns(this.host, this.judged.length);
    pen.clearRect(0, 0, this.width, this.height);
    curves.forEach((curve, at) => {
      const plot = livePlot(at, columns, this.width);
      const scale = liveScale(curve);
      const { name, unit } = itemAt(this.judged, at);
      drawLiveAxes(pen, plot, scale, span, look);
      pen.fillStyle = look.ink;
      pen.textAlign = "left";
      pen.textBaseline = "bottom";
      pen.fillText(`${name} ${unitInBrackets(unit)}`, plot.left - 50, plot.top - 6, plot.width + 50);
      pen.save();
      pen.beginPath();
      pen.rect(plot.left, plot.top - 2, plot.width, plot.height + 4);
      pen.clip();
      pen.lineWidth = 1.6;
      pen.strokeStyle = look.tones.threshold;
      pen.setLineDash([6, 4]);
      drawLiveCurve(pen, plot, curve.threshold, scale, span);
      pen.setLineDash([]);
      pen.lineWidth = 1.4;
      pen.strokeStyle = look.tones.residual;
      drawLiveCurve(pen, plot, curve.residual, scale, span);
      pen.restore();
    });
  }
}
