import type { Level, Value } from "../report/document";
import { element, within, type Attributes, type Child } from "../report/element";
import { formatNumber, withUnit } from "../report/format";
import { levelSymbol } from "../report/words";
import type { Parameter } from "./api";

/** "Coulomb friction" of "coulomb_friction". */
export function effectTitle(name: string) {
  const words = name.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** Words of the server in which these effects are called as the page calls them: "coulomb friction". */
export function withPlainNames(words: string, effects: string[]) {
  const name = new RegExp(`\\b(${effects.join("|")})\\b`, "g");
  return effects.length === 0 ? words : words.replace(name, (each) => each.replaceAll("_", " "));
}

export function percent(value: Value) {
  return value === null ? "–" : `${formatNumber(value, ".2f")}\u202f%`;
}

export function button(id: string, label: string, action: () => unknown, attributes: Attributes = {}) {
  const node = element("button", { type: "button", id, class: "action", ...attributes }, label);
  node.addEventListener("click", () => {
    if (node.getAttribute("aria-disabled") !== "true") action();
  });
  return node;
}

/**
 * Puts new content in the place of old. What was unfolded stays so, and who had the focus there keeps it;
 * where the control is gone it is on the place, from which the next key leads to what is there now.
 */
export function replaceContent(host: HTMLElement, ...children: Child[]) {
  const active = document.activeElement;
  const hadFocus = host.contains(active);
  const unfolded = [...host.querySelectorAll("details[open][id]")].map(({ id }) => id);
  host.replaceChildren(...children);
  for (const details of host.querySelectorAll<HTMLDetailsElement>("details[id]")) details.open = unfolded.includes(details.id);
  if (!hadFocus || active === null) return;
  const same = active.id === "" ? null : document.getElementById(active.id);
  if (same === null) host.tabIndex = -1;
  (same ?? host).focus({ preventScroll: true });
  // Who writes there goes on where the next letter comes.
  if (active instanceof HTMLInputElement && same instanceof HTMLInputElement && active.type === "text") {
    same.setSelectionRange(active.selectionStart, active.selectionEnd);
  }
}

/** While a change is under way no other begins: its controls say so, and keep the focus. */
export function holdControls(held: boolean) {
  for (const control of document.querySelectorAll(".switch, .action:not([data-free])")) {
    if (held && !control.hasAttribute("aria-disabled")) {
      control.setAttribute("aria-disabled", "true");
      control.setAttribute("data-held", "");
    } else if (!held && control.hasAttribute("data-held")) {
      control.removeAttribute("aria-disabled");
      control.removeAttribute("data-held");
    }
  }
}

export function sectionWith(id: string, heading: string, ...children: Child[]) {
  const root = element("section", { id, "aria-labelledby": `${id}-heading` });
  root.append(element("h2", { id: `${id}-heading` }, heading), ...children);
  return root;
}

export function foldWith(id: string, title: string) {
  return element("details", { id }, element("summary", { id: `${id}-summary` }, title));
}

export function noteWith(level: Level, ...children: Child[]) {
  const root = element("div", { class: `note ${level}`, role: "note" });
  const text = element("p", {}, levelSymbol(level), ...children);
  root.append(text);
  return root;
}

/** More words of a note, behind those that it has. */
export function addToNote(note: HTMLElement, ...children: Child[]) {
  within(note, "p").append(...children);
}

/** A term and, one click away, what it means. */
export function explained(summary: string, ...paragraphsOf: string[]) {
  const details = element("details", { class: "meaning" }, element("summary", {}, summary));
  for (const text of paragraphsOf) details.append(element("p", {}, text));
  return details;
}

/** A fitted number with its 95 % interval, or why it has none. */
type Estimated = Pick<Parameter, "value" | "unit" | "ci95" | "why_no_ci95">;

/** As many digits as tell the ends of an interval apart: "between 5 and 5" says nothing. */
function intervalWords(ends: readonly (number | null)[]) {
  for (const format of [".4g", ".5g", ".6g", ".7g", ".8g"]) {
    const [low, high] = ends.map((each) => formatNumber(each ?? null, format));
    if (low !== high) return `${low} and ${high}`;
  }
  return ends.map((each) => formatNumber(each ?? null, ".9g")).join(" and ");
}

/** "20.8 N (19.6 to 22)" of a fitted parameter. */
export function valueWords({ value, unit, ci95, why_no_ci95 }: Estimated) {
  const text = withUnit(formatNumber(value, ".4g"), unit);
  if (ci95) return `${text}, 95 % between ${intervalWords(ci95)}`;
  return why_no_ci95 ? `${text}, no interval: ${why_no_ci95}` : text;
}

/** What a later step has made of a fitted number; "" where it prints as it was fitted. */
export function laterWords({ value, unit }: Estimated, now: number | undefined) {
  const text = (each: number | null) => withUnit(formatNumber(each, ".4g"), unit);
  return now === undefined || text(now) === text(value) ? "" : `; now ${text(now)}, fitted again with a later step`;
}

/** `now`: of numbers that later steps have fitted again, the value that the model has. */
export function parameterList(parameters: [string, Estimated][], now: Record<string, { value: number }> = {}) {
  const list = element("ul", { class: "parameters" });
  for (const [name, parameter] of parameters) {
    const words = `${valueWords(parameter)}${laterWords(parameter, now[name]?.value)}`;
    list.append(element("li", {}, element("b", {}, name.replaceAll("_", " ")), ` ${words}`));
  }
  return list;
}

/** A file's name without its folders. */
export function baseName(path: string): string {
  return path.slice(path.lastIndexOf("/") + 1);
}
