import { byId, element } from "../report/element";
import { formatNumber, formatSignificant } from "../report/format";
import { itemAt } from "../report/lists";
import type { Actions } from "./actions";
import type { EffectAt, Explanation, FindingCard, FoundAnswer, JointAnswer, State } from "./api";
import { evidenceElement } from "./evidence";
import { button, effectTitle, foldWith, noteWith, parameterList, withPlainNames } from "./parts";

/** Which effect of which joint. */
type EffectOn = Pick<EffectAt, "effect" | "joint">;

/** An effect that can be added from an answer, or is. */
function addButton(what: EffectOn, id: string, added: boolean, actions: Actions) {
  const name = `${effectTitle(what.effect)}, joint ${what.joint}`;
  if (added) return element("span", { class: "added" }, `Added: ${name}`);
  const node = button(id, "Add", () => actions.add(what.effect, what.joint), { class: "action main" });
  node.append(element("span", { class: "hidden-text" }, ` ${name}`));
  return node;
}

/** That it is there and cannot be there once more. */
function isAdded(state: State, what: EffectOn) {
  const { effects } = itemAt(state.joints, what.joint - 1);
  const known = effects.find(({ effect }) => effect === what.effect);
  return known !== undefined && known.steps.length > 0 && !known.may_repeat;
}

function chanceWords(p: number | null) {
  if (p === null) return "";
  if (p < 1e-4) return "Chance does practically never do that.";
  return `By chance in one of ${formatSignificant(1 / p, 2)} such searches at most.`;
}

/** What it takes off the error, %. */
function shareOf({ takes_of_held_out }: FindingCard) {
  return takes_of_held_out === null ? null : 100 * takes_of_held_out;
}

function findingCard(card: FindingCard, id: string, search: number, state: State, actions: Actions) {
  const root = element("li", { class: "card finding" });
  const head = element("div", { class: "step-head" }, element("h4", {}, effectTitle(card.title)));
  head.append(addButton(card, `add-${id}`, isAdded(state, card), actions));
  const share = formatNumber(shareOf(card), ".0f");
  const whose = card.seen_on === card.joint ? "the joint's" : `joint ${card.seen_on}'s`;
  root.append(
    head,
    element("p", {}, `${card.words}. Its torque: `, element("code", {}, card.formula)),
    parameterList(card.parameters.map((each) => [each.name, each])),
    element(
      "p",
      {},
      `It takes ${share} % off ${whose} error on held-out data. ${chanceWords(card.p_value)}`,
    ),
  );
  if (card.finding !== null) {
    root.append(evidenceElement(`finding ${card.finding} of ${search}`, { search, finding: card.finding }));
  }
  if (card.alternatives.length > 0) {
    root.append(element("p", {}, "These recordings do not tell it from:"));
    root.append(choiceList(card.alternatives, id, state, actions));
  }
  return root;
}

function choiceList(effects: EffectAt[], id: string, state: State, actions: Actions) {
  const list = element("ul", { class: "choices" });
  effects.forEach((what, index) =>
    list.append(
      element(
        "li",
        {},
        element("span", {}, `${effectTitle(what.effect)}: ${what.words}. To tell it: ${what.motion}.`),
        addButton(what, `add-${id}-${index}`, isAdded(state, what), actions),
      ),
    ),
  );
  return list;
}

function plain(words: string, { joints }: State) {
  return withPlainNames(words, joints[0]?.effects.map(({ effect }) => effect) ?? []);
}

function jointAnswer(answer: JointAnswer, search: number, state: State, actions: Actions) {
  const root = element("div", { class: "answer" });
  root.append(element("h3", {}, `Joint ${answer.joint}`), element("p", {}, plain(answer.words, state)));
  const cards = element("ul", { class: "findings" });
  answer.cards.forEach((card, index) =>
    cards.append(findingCard(card, `${answer.joint}-${index}`, search, state, actions)),
  );
  if (answer.cards.length > 0) root.append(cards);
  answer.classes.forEach(({ effects: members, or_own_numbers: orOwn }, index) => {
    const words =
      orOwn
        ? "One of these is missing, or the model's own numbers are off; the recordings do not tell:"
        : "One of these is missing; the recordings do not tell which:";
    root.append(element("p", {}, words));
    root.append(choiceList(members, `${answer.joint}-class-${index}`, state, actions));
  });
  return root;
}

function answerElement(found: FoundAnswer, search: number, state: State, actions: Actions) {
  const root = element("div", {}, element("p", { class: "answer-words" }, plain(found.words, state)));
  const silent = found.joints.filter(
    ({ cards, classes }) => cards.length === 0 && classes.length === 0,
  );
  for (const answer of found.joints) {
    if (!silent.includes(answer)) root.append(jointAnswer(answer, search, state, actions));
  }
  if (silent.length > 0) {
    const rest = foldWith("nothing-to-add", `Joints with nothing to add (${silent.length})`);
    for (const answer of silent) rest.append(element("p", {}, plain(answer.words, state)));
    root.append(rest);
  }
  if (found.advice.length > 0) {
    const advice = foldWith("advice", "Advice");
    for (const text of found.advice) advice.append(element("p", {}, text));
    root.append(advice);
  }
  return root;
}

/** How long it has run stands beside what is read out: that is only what it does. */
function progressContent(found: Explanation, actions: Actions) {
  const doing = element("span", { id: "search-doing", role: "status" }, found.doing);
  const seconds = element("span", { id: "search-seconds" }, secondsWords(found));
  const progress = element("p", { class: "progress" }, element("span", { class: "spinner", "aria-hidden": "true" }));
  progress.append(element("span", {}, "Searching for ", seconds, ": ", doing, " …"));
  return [progress, button("stop-search", "Stop", actions.stop, { "data-free": "" })];
}

function secondsWords(found: Explanation) {
  return `${formatNumber(found.seconds, ".0f")} s`;
}

/** The same search goes on: false where its place does not show it yet. */
export function updateProgress(found: Explanation) {
  const doing = document.getElementById("search-doing");
  if (doing === null) return false;
  if (doing.textContent !== found.doing) doing.textContent = found.doing;
  byId("search-seconds").textContent = secondsWords(found);
  return true;
}

/** The search for what is missing: its button, its progress or its answer. */
export function learnContent(found: Explanation, state: State, actions: Actions) {
  if (found.state === "running") return progressContent(found, actions);
  const again = state.steps.length > 0;
  const content: HTMLElement[] = [
    button("search", again ? "Search what is left" : "Search for missing effects", actions.search, {
      class: "action main",
    }),
  ];
  if (found.state === "none") {
    content.unshift(
      element(
        "p",
        { class: "empty" },
        "The search tries every known effect on every joint, keeps what holds on data that no fit " +
          "has seen, and says what the recordings cannot tell. It runs in the background; charts " +
          "stay usable meanwhile, the model stays as it is.",
      ),
    );
  }
  if (found.state === "stopped") content.unshift(element("p", { class: "empty" }, "The search was stopped."));
  if (found.state === "failed") content.unshift(noteWith("bad", found.error));
  if (found.state === "done" && found.answer !== null) {
    if (found.revision !== state.revision) {
      content.unshift(
        noteWith("neutral", "The model has changed since this answer: search again for what is left now."),
      );
    }
    content.push(answerElement(found.answer, found.search ?? 0, state, actions));
  }
  return content;
}
