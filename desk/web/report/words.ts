import type { Level } from "./document";
import { element, within } from "./element";

export const kLevelWords: Record<Level, string> = { good: "Good", warn: "Warning", bad: "Bad", neutral: "" };

const kLevelPaths: Record<Level, string> = {
  good: '<path d="M5.5 10.5l3 3 6-7"/>',
  warn: '<path d="M10 5v6.2"/><path d="M10 14.4v.2"/>',
  bad: '<path d="M6.5 6.5l7 7M13.5 6.5l-7 7"/>',
  neutral: '<path d="M10 9v5.2"/><path d="M10 5.6v.2"/>',
};

export function levelSymbol(level: Level) {
  const holder = element("span", {});
  holder.innerHTML =
    '<svg class="symbol" viewBox="0 0 20 20" fill="none" stroke="currentColor" ' +
    `stroke-width="1.8" stroke-linecap="round" stroke-linejoin="round" aria-hidden="true">` +
    `<circle cx="10" cy="10" r="8.6" stroke-width="1.5"/>${kLevelPaths[level]}</svg>`;
  return within(holder, "svg");
}

export function hiddenText(text: string) {
  return text === "" ? "" : element("span", { class: "hidden-text" }, `${text}: `);
}

export function paragraphs(text: string) {
  const parts = text.split(/\n\s*\n/).filter((part) => part.trim() !== "");
  return parts.map((part) => element("p", {}, ...withCode(part)));
}

/** What stands between two backticks is for a terminal. */
function withCode(text: string) {
  const parts = text.split("`");
  if (parts.length % 2 === 0) return [text];
  return parts.map((part, index) => (index % 2 === 1 ? element("code", {}, part) : part)).filter((part) => part !== "");
}
