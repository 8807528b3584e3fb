import { keyFiguresElement } from "../report/blocks";
import type { KeyFigure, Level, Value } from "../report/document";
import { element, within } from "../report/element";
import { formatNumber } from "../report/format";
import type { Errors, Joint } from "./api";
import { choose } from "./changes";
import { choiceOf, type Choice } from "./choices";
import { baseName, explained, percent } from "./parts";
import { placeOf } from "./places";
import { hasResults, openRunTitle } from "./results";
import { currentJoint, look, rowNumbers, state, type RowNumbers } from "./session";

export function headerContent() {
  const names = (held: boolean) => state().recordings.filter((each) => each.held_out === held).map((each) => baseName(each.name));
  const judged = state().held_out === "recordings" ? names(true).join(", ") : "parts of the same, held out in turn";
  // Below results a run is a part of the page.
  const title = hasResults() ? element("h2", {}, openRunTitle()) : element("h1", {}, `Studio: ${state().robot.name}`);
  const header = element("header", {}, title);
  header.append(
    element(
      "p",
      { class: "subtitle" },
      `${state().robot.file} · fitted to ${names(false).join(", ")} · judged on ${judged}`,
    ),
  );
  return header;
}

function barWidth(value: number | null) {
  return `${Math.min(100, Math.max(0, value ?? 0))}%`;
}

function numbersOf({ start, now, words }: RowNumbers) {
  // Beside a long name there is no room for both.
  if (words !== "") return [element("b", {}, percent(now)), words];
  if (start === now) return [percent(now)];
  return [`${percent(start)} → `, element("b", {}, percent(now))];
}

/** The list of joints may stay in sight where the headline does not: it follows a number that is dragged, too. */
export function showDraggedJoint(dragged: Errors | null) {
  const row = placeOf("joints").querySelector(`label[for="joint-${look.joint}"]`);
  if (row === null) return;
  const numbers = rowNumbers(currentJoint(), dragged);
  within(row, ".joint-numbers").replaceChildren(...numbersOf(numbers));
  within<HTMLElement>(row, ".is").style.width = barWidth(numbers.now);
}

function jointRow(joint: Joint) {
  const id = `joint-${joint.joint}`;
  const input = element("input", { type: "radio", name: "joint", id, value: String(joint.joint) });
  input.checked = joint.joint === look.joint;
  input.addEventListener("change", () => choose({ joint: joint.joint }));
  const numbers = rowNumbers(joint, null);
  const bar = element("span", { class: "bar", "aria-hidden": "true" });
  bar.append(element("i", { class: "was", style: `width:${barWidth(numbers.start)}` }));
  bar.append(element("i", { class: "is", style: `width:${barWidth(numbers.now)}` }));
  const label = element("label", { for: id });
  label.append(
    element("span", { class: "joint-name" }, `${joint.joint}. ${joint.name}${joint.moves ? "" : " (stands still)"}`),
    bar,
    element("span", { class: "joint-numbers" }, ...numbersOf(numbers)),
  );
  return element("div", { class: "joint" }, input, label);
}

export function jointChoice() {
  const set = element("fieldset", { class: "joints" }, element("legend", {}, "Joint, and its error"));
  for (const joint of state().joints) set.append(jointRow(joint));
  return set;
}

function figureOf(label: string, value: Value, note: string, level: Level): KeyFigure {
  return { label, value, unit: "%", format: ".2f", level, note };
}

/** Without a recording that is held out, a fit alone leaves a part of the recording for its judge. */
function notHeldOut(isDragged: boolean) {
  return isDragged ? "no recording is held out: known at the fit" : "no recording is held out: known once an effect is added";
}

/** `dragged`: the errors of a model that is off its fit. */
export function headlineContent(dragged: Errors | null = null) {
  const joint = currentJoint();
  const { start } = joint;
  const now = dragged ?? joint.now;
  const fell = (key: keyof Errors) => {
    if (state().steps.length === 0 || start[key] === null || now[key] === null) return "as read";
    return `as read ${formatNumber(start[key], ".2f")} %`;
  };
  const better = (key: keyof Errors) => {
    const [before, after] = [start[key], now[key]];
    return before !== null && after !== null && after < 0.98 * before;
  };
  const figuresOf = [
    figureOf(
      `Joint ${joint.joint}: error on held-out data${dragged === null ? "" : ", dragged"}`,
      now.held_out_percent,
      now.held_out_percent === null ? notHeldOut(dragged !== null) : fell("held_out_percent"),
      better("held_out_percent") ? "good" : "neutral",
    ),
    figureOf(
      `Joint ${joint.joint}: error on fitted data${dragged === null ? "" : ", dragged"}`,
      now.fitted_percent,
      fell("fitted_percent"),
      "neutral",
    ),
  ];
  return keyFiguresElement({ figures: figuresOf }, "headline");
}

export function meaningContent() {
  return explained(
    "What do these numbers mean?",
    "The error is what the model misses of the measured torque: the root mean square of measured " +
      "minus model, as a share of that of the measured torque, both low-passed alike. 0 % is a " +
      "perfect model.",
    "Held-out data were not used for the fit: only an error that falls there shows that an effect " +
      "is real. On fitted data it falls with every number that is fitted.",
  );
}

export function recordingPicker() {
  const select = element("select", { id: "recording-choice" });
  state().recordings.forEach((each, index) => {
    const option = element(
      "option",
      { value: String(index + 1) },
      `${baseName(each.name)} (${each.held_out ? "held out" : "fitted"})`,
    );
    option.selected = index + 1 === look.recording;
    select.append(option);
  });
  select.addEventListener("change", () => choose({ recording: Number(select.value) }));
  const row = element("div", { class: "choice-row" }, element("label", { for: "recording-choice" }, "Recording"), select);
  if (state().recordings.length < 2) return row;
  const others = state().recordings.map((each, index): Choice => [String(index + 1), baseName(each.name)]);
  const options: Choice[] = [["", "none"], ...others.filter(([number]) => Number(number) !== look.recording)];
  const chosen = look.beside === null ? "" : String(look.beside);
  row.append(
    choiceOf("beside-choice", "and over it", options, chosen, (value) =>
      choose({ beside: value === "" ? null : Number(value) }),
    ),
  );
  return row;
}
