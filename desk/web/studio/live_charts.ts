import { element, penOf } from "../report/element";
import { formatTick, unitInBrackets } from "../report/format";
import { itemAt } from "../report/lists";
import { currentLook, darkPreference } from "../report/look";
import { kFontFamily, type Look } from "../report/palette";
import { kLiveWindowS, liveScale, type LiveCurve, type Point, type Scale } from "./live_curves";
import type { TimeRange } from "./time_range";

const kLiveRow = 132;

const kLiveTop = 26;

const kLiveBottom = 22;

const kLiveGap = 26;

const kLiveLeft = 62;

const kLiveRight = 18;

/** Above it two charts stand side by side. */
const kLiveWide = 900;

/** Where a chart's curves stand, in pixels of the page. */
interface Plot {
  left: number;
  top: number;
  width: number;
  height: number;
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
      pen.strokeStyle = look.tones.faint;
      drawLiveCurve(pen, plot, curve.act, scale, span);
      pen.setLineDash([]);
      pen.lineWidth = 1.4;
      pen.strokeStyle = look.tones.residual;
      drawLiveCurve(pen, plot, curve.residual, scale, span);
      pen.restore();
    });
  }
}
