import { element } from "../report/element";

/** What can be chosen: its value, and the words that the reader sees. */
export type Choice = [string, string];

function optionsOf(select: HTMLSelectElement, options: Choice[], chosen: string) {
  for (const [value, words] of options) {
    const option = element("option", { value }, words);
    option.selected = value === chosen;
    select.append(option);
  }
  return select;
}

/** A labelled choice; `taken` hears of another value. */
export function choiceOf(id: string, label: string, options: Choice[], chosen: string, taken: (value: string) => void) {
  const select = optionsOf(element("select", { id }), options, chosen);
  select.addEventListener("change", () => taken(select.value));
  return element("span", { class: "pick" }, element("label", { for: id }, label), select);
}

/** The same where the label is in the words around it. */
export function selectWith(id: string, label: string, options: Choice[], chosen: string, taken: (value: string) => void) {
  const select = optionsOf(element("select", { id, "aria-label": label }), options, chosen);
  select.addEventListener("change", () => taken(select.value));
  return select;
}
