import type { Drawn } from "../report/document";
import { byId, element, within } from "../report/element";
import { numbersElement } from "../report/figure";
import type { Figure } from "../report/figure_type";
import { scaleWords } from "../report/heatmap";
import { watchTables } from "../report/tables";

/** The whole figure around its drawing. */
function rootOf({ host }: Figure): HTMLElement {
  const root = host.closest("figure");
  if (root === null) throw new Error("the drawing stands in no figure");
  return root;
}

/** Another content in the same picture: what is hidden or zoomed stays so. */
export function refill(figure: Figure, block: Drawn) {
  const root = rootOf(figure);
  figure.block = block;
  figure.cursor = null;
  figure.host.style.height = `${figure.kind.height(block)}px`;
  const title = within(root, "h3");
  title.textContent = block.title;
  // The legend's too: it is drawn anew only when somebody sees it, and is read out before.
  for (const hidden of root.querySelectorAll(".hidden-text")) hidden.textContent = ` of ${block.title}`;
  figure.legend?.setAttribute("aria-label", `Series of ${block.title}`);
  const scale = root.querySelector(".scale");
  if (scale !== null && block.type === "heatmap") scale.textContent = scaleWords(block);
  byId(title.id.replace(/-title$/, "-words")).textContent = figure.kind.words(block);
  refillRemark(root, block.note);
  const numbers = within<HTMLDetailsElement>(root, "details");
  const open = numbers.open;
  const anew = numbersElement(figure);
  anew.open = open;
  numbers.replaceWith(anew);
  watchTables(anew);
}

function refillRemark(root: HTMLElement, note: string) {
  const there = root.querySelector(":scope > .remark");
  if (note === "") return there?.remove();
  const remark = there ?? element("p", { class: "remark" });
  if (there === null) within(root, "details").before(remark);
  remark.textContent = note;
}
