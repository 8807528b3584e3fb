import type { Drawn } from "./document";
import { element } from "./element";
import type { Figure, FigureHost } from "./figure_type";
import { scaleWords } from "./heatmap";
import { takeKeys } from "./keys";
import { kindOf } from "./kinds";
import { fileName, saveAs, savePicture } from "./picture";
import { scrollingTable } from "./tables";
import { resetZoom } from "./zoom";

/** Every figure of the page. */
export const figures: Figure[] = [];

/** A figure with its title, tools, legend and note; drawn later by drawFigure(). */
export function figureElement(block: Drawn, place: string): HTMLElement {
  return figureWith(block, place).root;
}

/** The same with the figure that it shows. */
export function figureWith(block: Drawn, place: string): { root: HTMLElement; figure: Figure } {
  const kind = kindOf(block);
  const id = `figure-${place.replace(".", "-")}`;
  const host: FigureHost = element("div", {
    class: "drawing",
    role: "img",
    "aria-labelledby": `${id}-title`,
    "aria-describedby": `${id}-words`,
    style: `height:${kind.height(block)}px`,
  });
  const none = { chart: null, extent: null, legend: null, cursor: null, option: null };
  const figure: Figure = { block, kind, host, place, ...none, hidden: new Set() };
  host.figure = figure;
  const title = element("h3", { id: `${id}-title` }, block.title);
  const root = element("figure", {
    class: `card ${block.width === "half" ? "half" : ""}`.trim(),
    "data-block": place,
  });
  root.append(element("div", { class: "figure-head" }, title, toolButtons(figure)));
  if (block.type === "heatmap") {
    root.append(element("p", { class: "scale" }, scaleWords(block)));
  }
  if (block.type === "chart") {
    figure.legend = element("ul", { class: "legend", "aria-label": `Series of ${block.title}` });
    root.append(figure.legend);
  }
  // Only a reader of the description hears what is hidden; it is not read a second time.
  root.append(host, element("p", { id: `${id}-words`, hidden: "" }, kind.words(block)));
  if (kind.cursor !== null) root.append(takeKeys(figure));
  if (block.note !== "") root.append(element("p", { class: "remark" }, block.note));
  root.append(numbersElement(figure));
  figures.push(figure);
  return { root, figure };
}

/** The picture's content for those who do not see it. */
export function numbersElement({ block, kind }: Figure) {
  const summary = element("summary", {}, "Numbers", ofTitle(block));
  const caption = `Numbers of ${block.title}`;
  return element("details", {}, summary, scrollingTable({ caption, ...kind.numbers(block) }));
}

/** Ends the name of a control that every figure has. */
export function ofTitle(block: { title: string }) {
  return element("span", { class: "hidden-text" }, ` of ${block.title}`);
}

function toolButtons(figure: Figure) {
  const tools = element("div", { class: "tools" });
  const add = (label: string, action: () => void) => {
    const button = element("button", { type: "button" }, label, ofTitle(figure.block));
    button.addEventListener("click", action);
    tools.append(button);
  };
  if (figure.kind.cursor !== null) add("Reset zoom", () => resetZoom(figure));
  add("Save picture", () => savePicture(figure));
  add("Save CSV", () => {
    const blob = new Blob([figure.kind.csv(figure.block)], { type: "text/csv" });
    saveAs(URL.createObjectURL(blob), fileName(figure, "csv"));
  });
  return tools;
}
