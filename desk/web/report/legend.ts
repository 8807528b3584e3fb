import { element } from "./element";
import { ofTitle } from "./figure";
import { chartOf, type Figure } from "./figure_type";
import { seriesColors, swatch, type Look } from "./palette";

export function fillLegend(figure: Figure, look: Look) {
  const { block, legend, hidden } = figure;
  if (block.type !== "chart" || legend === null) return;
  const colors = seriesColors(block.series, look);
  const items = block.series.map((series, index) => {
    const button = element("button", {
      type: "button",
      "aria-pressed": String(!hidden.has(series.name)),
      "data-series": series.name,
    });
    button.innerHTML = swatch(series, colors[index] ?? look.ink);
    button.append(element("span", {}, series.name), ofTitle(block));
    button.addEventListener("click", () =>
      chartOf(figure).dispatchAction({ type: "legendToggleSelect", name: series.name }),
    );
    return element("li", {}, button);
  });
  legend.replaceChildren(...items);
}

export function watchLegend(figure: Figure) {
  chartOf(figure).on("legendselectchanged", (event) => {
    const { selected } = event as { selected: Record<string, boolean> };
    for (const button of figure.legend?.querySelectorAll("button") ?? []) {
      const name = button.dataset.series ?? "";
      const shown = selected[name] !== false;
      button.setAttribute("aria-pressed", String(shown));
      if (shown) figure.hidden.delete(name);
      else figure.hidden.add(name);
    }
  });
}
