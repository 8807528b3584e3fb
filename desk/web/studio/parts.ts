/** "Coulomb friction" of "coulomb_friction". */
function effectTitle(name) {
  const words = name.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

function percent(value) {
  return value === null ? "–" : `${formatNumber(value, ".2f")}\u202f%`;
}

function button(id, label, action, attributes = {}) {
  const node = element("button", { type: "button", id, class: "action", ...attributes }, label);
  node.addEventListener("click", () => {
    if (node.getAttribute("aria-disabled") !== "true") action();
  });
  return node;
}

function joined(items, separator) {
  return items.flatMap((item, index) => (index === 0 ? [item] : [separator, item]));
}

/**
 * Puts new content in the place of old. What was unfolded stays so, and who had the focus there keeps it;
 * where the control is gone it is on the place, from which the next key leads to what is there now.
 */
function replaceContent(host, ...children) {
  const active = document.activeElement;
  const hadFocus = host.contains(active);
  const unfolded = [...host.querySelectorAll("details[open][id]")].map(({ id }) => id);
  host.replaceChildren(...children);
  for (const details of host.querySelectorAll("details[id]")) details.open = unfolded.includes(details.id);
  if (!hadFocus) return;
  const same = active.id === "" ? null : document.getElementById(active.id);
  if (same === null) host.tabIndex = -1;
  (same ?? host).focus({ preventScroll: true });
}

/** While a change is under way no other begins: its controls say so, and keep the focus. */
function holdControls(held) {
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

function sectionWith(id, heading, ...children) {
  const root = element("section", { id, "aria-labelledby": `${id}-heading` });
  root.append(element("h2", { id: `${id}-heading` }, heading), ...children);
  return root;
}

function foldWith(id, title) {
  return element("details", { id }, element("summary", { id: `${id}-summary` }, title));
}

function noteWith(level, ...children) {
  const root = element("div", { class: `note ${level}`, role: "note" });
  const text = element("p", {}, levelSymbol(level), ...children);
  root.append(text);
  return root;
}

/** A term and, one click away, what it means. */
function explained(summary, ...paragraphsOf) {
  const details = element("details", { class: "meaning" }, element("summary", {}, summary));
  for (const text of paragraphsOf) details.append(element("p", {}, text));
  return details;
}

/** "20.8 N (19.6 to 22)" of a fitted parameter. */
function valueWords({ value, unit, ci95, why_no_ci95 }) {
  const number = (each) => formatSignificant(each, 4);
  const text = withUnit(number(value), unit);
  if (ci95) return `${text}, 95 % between ${number(ci95[0])} and ${number(ci95[1])}`;
  return why_no_ci95 ? `${text}, no interval: ${why_no_ci95}` : text;
}

function parameterList(parameters) {
  const list = element("ul", { class: "parameters" });
  for (const [name, parameter] of parameters) {
    list.append(
      element("li", {}, element("b", {}, name.replaceAll("_", " ")), ` ${valueWords(parameter)}`),
    );
  }
  return list;
}
