import { visibleRange } from "./cursors";
import { byId, element } from "./element";
import { chartOf, type Arrow, type Figure } from "./figure_type";
import { formatSignificant, withUnit } from "./format";
import { zoomTo, type ZoomChange } from "./zoom";

const kKeyWords =
  "Arrow keys show values, + and - zoom, shift and an arrow moves the range, 0 shows all of it.";

export const kArrows: Record<string, Arrow> = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

const kSmallestShare = 0.01;

/** Makes a figure whose kind has a cursor answer the keyboard; returns the hint shown meanwhile. */
export function takeKeys(figure: Figure) {
  const { host } = figure;
  const hint = element("p", { class: "keys", id: `${host.getAttribute("aria-labelledby")}-keys` });
  hint.append(kKeyWords);
  host.setAttribute("role", "application");
  host.setAttribute("aria-roledescription", "chart");
  host.setAttribute("tabindex", "0");
  host.setAttribute("aria-describedby", `${host.getAttribute("aria-describedby")} ${hint.id}`);
  host.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (obey(figure, event)) event.preventDefault();
  });
  host.addEventListener("blur", () => hideTip(figure));
  return hint;
}

/** Whether the key meant anything to the figure. */
function obey(figure: Figure, { key, shiftKey }: KeyboardEvent) {
  const arrow = kArrows[key];
  if (arrow && shiftKey) moveRange(figure, arrow);
  else if (arrow) return moveCursor(figure, arrow);
  else if (key === "+" || key === "=") zoomBy(figure, 0.5);
  else if (key === "-") zoomBy(figure, 2);
  else if (key === "0") zoomByKey(figure, () => ({ start: 0, end: 100 }));
  else if (key === "Escape") hideTip(figure);
  else return false;
  return true;
}

/** What a reader who does not see the picture hears. */
export function say(words: string) {
  byId("spoken").textContent = words;
}

function hideTip({ chart }: Figure) {
  chart?.dispatchAction({ type: "hideTip" });
  chart?.dispatchAction({ type: "updateAxisPointer", currTrigger: "leave" });
}

function zoomByKey(figure: Figure, change: ZoomChange) {
  hideTip(figure);
  zoomTo(figure, change);
  const { block } = figure;
  if (block.type === "waterfall") return;
  const ends = visibleRange(figure, "x").map((end) => formatSignificant(end, 4));
  say(withUnit(`${block.x.name} ${ends.join(" to ")}`, block.x.unit));
}

/** Zooms about the middle of what is shown. */
function zoomBy(figure: Figure, factor: number) {
  zoomByKey(figure, ({ start, end }) => {
    const share = Math.min(100, Math.max(kSmallestShare, (end - start) * factor));
    const from = Math.min(100 - share, Math.max(0, (start + end - share) / 2));
    return { start: from, end: from + share };
  });
}

/** A map's second zoom is that of its y axis. */
function moveRange(figure: Figure, [right, up]: Arrow) {
  const isMap = figure.block.type === "heatmap";
  zoomByKey(figure, ({ start, end }, index) => {
    const steps = isMap && index === 1 ? up : right;
    const way = Math.max(-start, Math.min(100 - end, steps * 0.2 * (end - start)));
    return { start: start + way, end: end + way };
  });
}

/** Shows the tip of the next place in the arrow's direction; false where there is none that way. */
function moveCursor(figure: Figure, arrow: Arrow) {
  const place = figure.kind.cursor?.(figure, arrow) ?? null;
  if (place === null) return false;
  chartOf(figure).dispatchAction({ type: "showTip", ...place });
  const tip = figure.host.querySelector(".tip table");
  const lines = tip ? [...tip.querySelectorAll("caption, tr")] : [];
  say(lines.map((line) => [...line.childNodes].map((each) => each.textContent).join(" ")).join("; "));
  return true;
}
