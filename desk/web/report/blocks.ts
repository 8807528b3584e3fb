import type { Block, KeyFigure, Note } from "./document";
import { element } from "./element";
import { figureElement } from "./figure";
import { formatNumber, withUnit } from "./format";
import { tableElement } from "./tables";
import { hiddenText, kLevelWords, levelSymbol, paragraphs } from "./words";

export function keyFiguresElement(block: { figures: KeyFigure[] }, place: string) {
  const list = element("dl", { class: "figures", "data-block": place });
  for (const figure of block.figures) {
    const shown = typeof figure.value === "string" ? figure.value : formatNumber(figure.value, figure.format);
    const value = element("dd", { class: "value" }, hiddenText(kLevelWords[figure.level]), shown);
    if (withUnit("", figure.unit) !== "" && shown !== "–") {
      const space = figure.unit === "%" ? "\u202f" : "\u00a0";
      value.append(element("span", { class: "unit" }, space + figure.unit));
    }
    if (figure.level !== "neutral") value.append(levelSymbol(figure.level));
    const item = element("div", { class: figure.level }, element("dt", {}, figure.label), value);
    if (figure.note !== "") item.append(element("dd", { class: "remark" }, figure.note));
    list.append(item);
  }
  return list;
}

function noteElement(block: Note, place: string) {
  const root = element("div", { class: `note ${block.level}`, role: "note", "data-block": place });
  const [first = element("p"), ...others] = paragraphs(block.text);
  first.prepend(levelSymbol(block.level), hiddenText(kLevelWords[block.level]));
  root.append(first, ...others);
  return root;
}

export function blockElement(block: Block, place: string) {
  if (block.type === "table") return tableElement(block, place);
  if (block.type === "key_figures") return keyFiguresElement(block, place);
  if (block.type === "note") return noteElement(block, place);
  return figureElement(block, place);
}
