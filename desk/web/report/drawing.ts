import { xExtent } from "./chart";
import type { Drawn } from "./document";
import { connect, init } from "./echarts";
import { figures } from "./figure";
import type { Figure } from "./figure_type";
import { fillLegend, watchLegend } from "./legend";
import { currentLook, darkPreference } from "./look";
import { leaveWheelToPage, resetZoom, setZoomBrush, watchShift, watchZoom } from "./zoom";

/** (Re)draws the figure in the present look and size; zoom and hidden series stay. */
export function drawFigure(figure: Figure) {
  const look = currentLook();
  const { block, kind, host } = figure;
  if (figure.chart === null) {
    figure.chart = init(host, null, { renderer: "canvas" });
    const group = zoomGroup(block);
    if (group !== "") {
      figure.chart.group = group;
      connect(group);
    }
    if (kind.cursor !== null) {
      figure.chart.getZr().on("dblclick", () => resetZoom(figure));
      watchZoom(figure);
      leaveWheelToPage(host);
    }
    if (figure.legend !== null) watchLegend(figure);
  }
  const isShown = (name: string) => !figure.hidden.has(name);
  const isFirst = figure.option === null;
  figure.option = kind.option(block, look, host.clientWidth, figure.extent, isShown);
  // The tool that zooms, told once: told again it has to be taken up again, which draws all anew.
  const { toolbox, ...others } = figure.option;
  figure.chart.setOption(isFirst ? figure.option : others, { replaceMerge: ["series"] });
  if (figure.legend !== null) fillLegend(figure, look);
  if (kind.cursor !== null && isFirst) setZoomBrush(figure, true);
}

/** Charts of one group zoom together; empty: it zooms alone. */
export function zoomGroup(block: Drawn): string {
  return block.type === "chart" ? block.zoom_group : "";
}

/** Charts of one zoom group share the x range that covers them all. */
export function shareExtents() {
  const blocks = figures.flatMap(({ block }) => (block.type === "chart" ? [block] : []));
  for (const figure of figures) {
    const { block } = figure;
    if (block.type !== "chart") continue;
    const group = block.zoom_group;
    figure.extent = xExtent(group ? blocks.filter((other) => other.zoom_group === group) : [block]);
  }
}

/** Those of the recording that is shown; the others are drawn when they are. */
export function shownFigures() {
  return figures.filter(({ host }) => host.closest("[hidden]") === null);
}

/** In the present width and colours, whatever it was drawn in. */
export function redraw(figure: Figure) {
  figure.option = null; // in other colours, its tool too
  figure.chart?.resize();
  drawFigure(figure);
}

export function redrawAll() {
  shownFigures().forEach(redraw);
}

export function drawAll() {
  shareExtents();
  shownFigures().forEach(drawFigure);
  followWindow();
}

let isFollowing = false;

/** From the first time on all figures follow the window's width and colours, and the paper's. */
export function followWindow() {
  if (isFollowing) return;
  isFollowing = true;
  darkPreference.addEventListener("change", redrawAll);
  let width = window.innerWidth;
  window.addEventListener("resize", () => {
    if (window.innerWidth === width) return;
    width = window.innerWidth;
    redrawAll();
  });
  watchShift();
  watchPrinting();
}

/** Paper is white and narrower than the window. */
function watchPrinting() {
  const kPaperWidth = 640;
  window.addEventListener("beforeprint", () => {
    document.documentElement.setAttribute("data-print", "");
    for (const figure of shownFigures()) {
      figure.chart?.resize({ width: kPaperWidth });
      drawFigure(figure);
    }
  });
  window.addEventListener("afterprint", () => {
    document.documentElement.removeAttribute("data-print");
    for (const figure of shownFigures()) figure.chart?.resize({ width: "auto" });
    redrawAll();
  });
}
