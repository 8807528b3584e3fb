import { drawFigure } from "../report/drawing";
import type { Figure } from "../report/figure_type";

/** Figures whose content is newer than their drawing: nobody sees them now. */
const stale = new Set<Figure>();

/** The figure is gone. */
export function forgetDrawing(figure: Figure) {
  stale.delete(figure);
}

/** What is in the window at once, the others as soon as there is nothing else to do, one by one. */
export function drawSoon(figuresOf: Figure[]) {
  for (const figure of figuresOf) {
    if (isInWindow(figure)) drawNow(figure);
    else stale.add(figure);
  }
  whenIdle();
}

function isInWindow({ host }: Figure) {
  const { top, bottom } = host.getBoundingClientRect();
  return bottom > 0 && top < window.innerHeight;
}

function drawNow(figure: Figure) {
  stale.delete(figure);
  const { chart, host } = figure;
  if (chart && (chart.getWidth() !== host.clientWidth || chart.getHeight() !== host.clientHeight)) chart.resize();
  drawFigure(figure);
}

let isIdleAsked = false;

function whenIdle() {
  if (isIdleAsked || stale.size === 0) return;
  isIdleAsked = true;
  requestIdleCallback(
    () => {
      isIdleAsked = false;
      const [next] = stale;
      if (next) drawNow(next);
      whenIdle();
    },
    { timeout: 1000 },
  );
}

/** Whoever scrolls there sees what is new. */
window.addEventListener(
  "scroll",
  () => {
    for (const figure of stale) if (isInWindow(figure)) drawNow(figure);
  },
  { passive: true },
);

