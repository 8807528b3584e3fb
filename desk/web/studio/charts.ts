import type { Chart, Drawn, Waterfall } from "../report/document";
import { drawAll, shareExtents, zoomGroup } from "../report/drawing";
import { figures, figureWith } from "../report/figure";
import { chartOf, type Figure } from "../report/figure_type";
import { itemAt } from "../report/lists";
import { watchTables } from "../report/tables";
import { resetZoom, zoomsOf, zoomTo } from "../report/zoom";
import type { AnswerTo, QueryTo } from "./api";
import { followChart } from "./cursor";
import { drawSoon } from "./draw_soon";
import { refill } from "./refill";
import type { Looked } from "./session";
import { rangeOf, type TimeRange } from "./time_range";

/** The figures of the joint that is looked at, by their place; made once, then filled anew. */
export const drawn = new Map<string, Figure>();

export function makeFigure(block: Drawn, place: string, host: HTMLElement) {
  const { root, figure } = figureWith(block, place);
  host.append(root);
  watchTables(root);
  drawn.set(place, figure);
  return figure;
}

/** Charts over time, which zoom together. */
export function timeFigures(): Figure[] {
  return [...drawn.values()].filter(({ block }) => zoomGroup(block) !== "");
}

function chartPixels() {
  const width = timeFigures()[0]?.host.clientWidth || document.documentElement.clientWidth;
  return Math.min(8000, Math.max(100, Math.round(width * (window.devicePixelRatio || 1))));
}

/** What the charts of what is looked at are asked for with. */
export function chartQuery(look: Looked, range: TimeRange | null): QueryTo<"GET", "/charts"> {
  const { joint, recording, beside } = look;
  return { joint, recording, pixels: chartPixels(), ...(beside === null ? {} : { beside }), ...range };
}

/** Those of places that begin so are gone. */
export function forgetFigures(beginning: string) {
  for (let at = figures.length - 1; at >= 0; --at) {
    const figure = itemAt(figures, at);
    if (!figure.place.startsWith(beginning)) continue;
    figure.chart?.dispose();
    figures.splice(at, 1);
  }
}

/** The picture of this place: made where there is none yet, else filled anew. */
function filledFigure(place: string, block: Drawn, host: HTMLElement): Figure {
  const there = drawn.get(place);
  if (there === undefined) return makeFigure(block, place, host);
  refill(there, block);
  return there;
}

/** The charts of another model, joint or recording. */
export function showCharts(answer: AnswerTo<"GET", "/charts">, host: HTMLElement, fallHost: HTMLElement) {
  const first = drawn.size === 0;
  const shown = answer.charts.map((block, index) => filledFigure(`chart.${index}`, block, host));
  shown.push(filledFigure("fall.0", answer.waterfall, fallHost));
  if (first) {
    drawAll();
    for (const figure of timeFigures()) {
      chartOf(figure).on("datazoom", zoomed);
      followChart(figure);
    }
    return;
  }
  shareExtents();
  drawSoon(shown);
}

/** A picture that no other depends on. */
export function showAlone(place: string, block: Drawn, host: HTMLElement) {
  const figure = filledFigure(place, block, host);
  shareExtents();
  drawSoon([figure]);
}

/** The same charts: finer over the time that the reader has zoomed, that time marked in the others. */
export function showFiner(answer: { charts: Chart[]; waterfall?: Waterfall }) {
  const blocks: [string, Drawn][] = answer.charts.map((block, index) => [`chart.${index}`, block]);
  if (answer.waterfall) blocks.push(["fall.0", answer.waterfall]);
  const shown = blocks.flatMap(([place, block]) => {
    const figure = drawn.get(place);
    if (figure === undefined) return [];
    refill(figure, block);
    return [figure];
  });
  drawSoon(shown);
}

let zoomTimer = 0;

let onZoom: (range: TimeRange | null) => void = () => {};

/** Whom to tell of a zoom. */
export function tellOfZoom(told: (range: TimeRange | null) => void) {
  onZoom = told;
}

/** Once the reader has come to rest. */
function zoomed() {
  window.clearTimeout(zoomTimer);
  zoomTimer = window.setTimeout(() => onZoom(zoomRange()), 120);
}

/** What is shown of the time; null: all of it. */
export function zoomRange(): TimeRange | null {
  const figure = timeFigures()[0];
  if (!figure?.chart) return null;
  return rangeOf(itemAt(zoomsOf(figure.chart), 0));
}

/** Zooms to a part of the time. */
export function showTime({ from, to }: TimeRange) {
  const [figure] = timeFigures();
  if (figure?.chart) zoomTo(figure, () => ({ startValue: from, endValue: to }));
}

export function showWhole() {
  const [figure] = timeFigures();
  if (figure?.chart && zoomRange() !== null) resetZoom(figure);
}
