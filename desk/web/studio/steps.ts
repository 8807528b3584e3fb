import { element } from "../report/element";
import type { Actions } from "./actions";
import type { Effect, Joint, State, Step } from "./api";
import { dragElement } from "./drag";
import { stepEvidence } from "./evidence";
import { button, effectTitle, foldWith, noteWith, parameterList, percent } from "./parts";

/** One effect of a joint: a switch, its name and words, and one click away its formula. */
function effectRow(effect: Effect, joint: number, actions: Actions) {
  const on = effect.in_file || effect.steps.length > 0;
  const locked = effect.in_file || (!on && effect.why_not !== "");
  const id = `switch-${effect.effect}`;
  const control = button(id, "", () => actions.toggle(effect, joint), {
    class: "switch",
    role: "switch",
    "aria-checked": String(on),
    "aria-labelledby": `${id}-name`,
    "aria-describedby": `${id}-words`,
    ...(locked ? { "aria-disabled": "true" } : {}),
  });
  const name = element("span", { class: "effect-name", id: `${id}-name` }, effectTitle(effect.effect));
  const details = element(
    "details",
    { class: "effect-text", id: `${id}-text` },
    element("summary", { id: `${id}-summary` }, name),
    element("p", {}, "Its torque: ", element("code", {}, effect.formula)),
  );
  const words = element("p", { class: "effect-words", id: `${id}-words` }, effect.words);
  if (effect.in_file) words.append(element("b", {}, " · in the robot file"));
  else if (locked) words.append(element("b", {}, ` · not possible: ${effect.why_not}`));
  const told = element("div", {}, details, words);
  const row = element("li", { class: on ? "on" : "" }, control, told);
  if (on && effect.may_repeat && effect.why_not === "") {
    told.append(button(`more-${effect.effect}`, "Add another", () => actions.add(effect.effect, joint)));
  }
  return row;
}

/** The switches of a joint; what cannot act there is folded up. */
export function effectList(joint: Joint, actions: Actions) {
  const possible = (effect: Effect) =>
    effect.in_file || effect.steps.length > 0 || effect.why_not === "";
  const list = element("ul", { class: "effects" });
  for (const effect of joint.effects.filter(possible)) list.append(effectRow(effect, joint.joint, actions));
  const others = joint.effects.filter((effect) => !possible(effect));
  if (others.length === 0) return [list];
  const rest = element("ul", { class: "effects" });
  for (const effect of others) rest.append(effectRow(effect, joint.joint, actions));
  const fold = element("details", { id: "other-effects" }, element("summary", { id: "other-effects-summary" }, `Not on this joint (${others.length})`));
  fold.append(rest);
  return [list, fold];
}

function stepRow(step: Step, number: number, revision: number, actions: Actions) {
  const name = `${effectTitle(step.effect)}, joint ${step.joint}`;
  const undo = button(`undo-${step.id}`, "Undo", () => actions.undo(step.id));
  undo.append(element("span", { class: "hidden-text" }, ` ${name}`));
  const { before, after } = step;
  const told = after.held_out_percent === null ? "fitted_percent" : "held_out_percent";
  const fall = element(
    "span",
    { class: "fall" },
    `${percent(before[told])} → `,
    element("b", {}, percent(after[told])),
  );
  const head = element("div", { class: "step-head" }, element("h3", {}, `${number}. ${name}`), fall, undo);
  const row = element("li", { class: "card step" }, head);
  row.append(parameterList(Object.entries(step.parameters), step.draggable));
  for (const doubt of step.doubts) row.append(noteWith("warn", doubt));
  row.append(stepEvidence(step, revision));
  if (Object.keys(step.draggable).length > 0) row.append(dragElement(step, actions));
  if (step.notes.length > 0 || step.refitted.length > 0) row.append(stepDetails(step));
  return row;
}

function stepDetails(step: Step) {
  const id = `more-of-step-${step.id}`;
  const details = foldWith(id, "More of this fit");
  for (const other of step.refitted) {
    details.append(
      element("p", {}, `Fitted again with it: ${effectTitle(other.effect)}, joint ${other.joint}`),
      parameterList(Object.entries(other.parameters)),
    );
  }
  for (const note of step.notes) details.append(element("p", {}, note));
  return details;
}

export function stepList({ steps, revision, held_out }: State, actions: Actions) {
  if (steps.length === 0) {
    return element(
      "p",
      { class: "empty" },
      "Nothing is added yet. Switch an effect on, or let the search below say which one is missing.",
    );
  }
  const list = element("ol", { class: "steps" });
  steps.forEach((step, index) => list.append(stepRow(step, index + 1, revision, actions)));
  if (held_out === "recordings" || steps.length < 2) return list;
  const why = "No recording is held out: each step is judged on parts of the recordings that its own fit leaves out. What a step begins with may differ from what the one before it ended with.";
  return element("div", {}, list, element("p", { class: "soft" }, why));
}
