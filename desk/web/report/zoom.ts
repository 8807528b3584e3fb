import { edgeLabels } from "./axes";
import { xLabelCount } from "./chart";
import type { ECharts } from "./echarts";
import { figures } from "./figure";
import { chartOf, type Figure } from "./figure_type";

/** From where to where an axis is shown: in percent, and in its own unit. */
export interface Zoom {
  start: number;
  end: number;
  startValue: number;
  endValue: number;
}

/** Part of a zoom that is new. */
export type ZoomChange = (zoom: Zoom, index: number) => Partial<Zoom>;

export function zoomsOf(chart: ECharts): Zoom[] {
  return chart.getOption().dataZoom as Zoom[];
}

export function resetZoom(figure: Figure) {
  zoomTo(figure, () => ({ start: 0, end: 100 }));
}

/** Every zoom of the figure to what change({start, end}), in percent, makes of it. */
export function zoomTo(figure: Figure, change: ZoomChange) {
  const batch = zoomsOf(chartOf(figure)).map((zoom, dataZoomIndex) => ({ dataZoomIndex, ...change(zoom, dataZoomIndex) }));
  chartOf(figure).dispatchAction({ type: "dataZoom", batch });
}

/** After a zoom the x axis begins and ends anywhere: see edgeLabels(). */
export function watchZoom(figure: Figure) {
  const chart = chartOf(figure);
  const { block } = figure;
  if (block.type === "waterfall") return;
  const axes = block.type === "heatmap" ? { x: block.x, y: block.y } : { x: block.x };
  const refresh = () => {
    const zooms = zoomsOf(chart);
    const option: Record<string, object> = {};
    Object.entries(axes).forEach(([name, { log }], index) => {
      const { startValue, endValue } = zooms[index] ?? { startValue: 0, endValue: 0 };
      if (!(startValue < endValue)) return;
      const count = name === "x" && block.type === "chart" ? xLabelCount(block) : 5;
      option[`${name}Axis`] = { axisLabel: edgeLabels(startValue, endValue, count, log) };
    });
    const text = JSON.stringify(option);
    if (text !== figure.edges) chart.setOption(option);
    figure.edges = text;
  };
  chart.on("datazoom", refresh);
}

/** ECharts takes every turn of the wheel; the page needs those without ctrl to scroll. */
export function leaveWheelToPage(host: HTMLElement) {
  for (const name of ["wheel", "mousewheel"]) {
    const pass = (event: Event) => (event as WheelEvent).ctrlKey || event.stopPropagation();
    host.addEventListener(name, pass, { capture: true, passive: true });
  }
}

/** While shift is held a drag moves the zoomed range, else it chooses one. */
export function setZoomBrush(figure: Figure, active: boolean) {
  chartOf(figure).dispatchAction({
    type: "takeGlobalCursor",
    key: "dataZoomSelect",
    dataZoomSelectActive: active,
  });
}

export function watchShift() {
  const zoomed = figures.filter((figure) => figure.kind.cursor !== null);
  const set = (active: boolean) =>
    zoomed.filter(({ chart }) => chart !== null).forEach((figure) => setZoomBrush(figure, active));
  window.addEventListener("keydown", ({ key, repeat }) => {
    if (key === "Shift" && !repeat) set(false);
  });
  window.addEventListener("keyup", ({ key }) => {
    if (key === "Shift") set(true);
  });
  window.addEventListener("blur", () => set(true));
}
