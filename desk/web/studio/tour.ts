import { element } from "../report/element";
import { button, effectTitle, percent } from "./parts";
import { placeOf } from "./places";
import { currentJoint, errorOf, session, state } from "./session";
import { endOf, stageOf, type TourEnd, type TourStage } from "./tour_stage";

/** A walk through what the page is for, over whichever recordings are loaded: it says what to press, and sees what came of it. */
const tour: { on: boolean; hasLooked: boolean; isSkipped: boolean } = { on: false, hasLooked: false, isSkipped: false };

type Told = { title: string; words: string; before: HTMLElement; target: string | null };

/** "73.58 % as read, 11.31 % now" */
function errorWords() {
  const joint = currentJoint();
  const which = joint.now.held_out_percent === null ? "error on fitted data" : "error on held-out data";
  const [start, now] = [errorOf(joint, "start"), errorOf(joint, "now")];
  return `Joint ${joint.joint}: ${which} ${percent(start)} as read${start === now ? "" : `, ${percent(now)} now`}.`;
}

const kAddedWords = "The steps above have the numbers with their intervals, sliders to feel what each does, and Undo. “Save” below writes the robot file with them; the commands beneath it do the same without this page.";

const kLaterWords = "What is added becomes a step above, with its numbers and their intervals, sliders and Undo; “Save” below writes the robot file with all steps.";

const kEndWords: Record<Exclude<TourEnd, "added">, string> = {
  "nothing found": "The search names nothing to add: it says why above. The model is as it was read.",
  "not added": "Nothing of what the search has found is added: the model is as it was read. “Add” above changes that.",
  searching: "The search still runs, and the model is as it was read. What it finds comes up above, each with “Add”.",
  "not searched": "No search has run and nothing is added: the model is as it was read. “Search for missing effects” above looks for what it lacks.",
};

function toldOf(stage: TourStage): Told {
  if (!tour.hasLooked) {
    const words = `${errorWords()} So much of the measured torque the robot file does not explain; where it does not is in the charts below, measured and model over each other. A model without friction often begins beyond 50 %. Next is what is missing.`;
    return { title: "Guided tour: look", words, before: placeOf("headline"), target: null };
  }
  if (stage.part === "search") {
    return { title: "Guided tour: click 1", words: "Press “Search for missing effects”, which is marked below: every known effect is tried on every joint, on data that no fit has seen. The model stays as it is.", before: placeOf("learn"), target: "search" };
  }
  if (stage.part === "wait") {
    return { title: "Guided tour: the search", words: "It runs, some seconds for one joint and minutes for seven. What it finds comes up below.", before: placeOf("learn"), target: null };
  }
  if (stage.part === "add") {
    const { click, clicks, next } = stage;
    const words = `${errorWords()} Press “Add” of ${effectTitle(next.effect)}, joint ${next.joint}, which is marked, and watch the error.`;
    return { title: `Guided tour: click ${click} of ${clicks}`, words, before: placeOf("learn"), target: next.id };
  }
  const words = stage.came === "added" ? `${errorWords()} ${kAddedWords}` : `${kEndWords[stage.came]} ${kLaterWords}`;
  return { title: "Guided tour: what came of it", words, before: placeOf("save"), target: null };
}

function stageNow(): TourStage {
  return tour.isSkipped ? { part: "end", came: endOf(session.found, state()) } : stageOf(session.found, state());
}

const title = element("p", { class: "tour-title" });
const words = element("p", { role: "status" });
const next = button("tour-next", "Next", advance, { "data-free": "" });
const end = button("tour-end", "End the tour", () => endTour(), { "data-free": "" });
const callout = element("div", { id: "tour-callout", class: "tour", role: "region", tabindex: "-1", "aria-label": "Guided tour" }, title, words, element("div", { class: "choice-row" }, next, end));

/** Charts that are drawn late push it out of the window again. */
const kLookAgain = [0, 300, 800, 1500]; // [ms]

function bringIntoView() {
  for (const later of kLookAgain) {
    setTimeout(() => {
      const { top, bottom } = callout.getBoundingClientRect();
      const isSeen = top >= 0 && bottom <= window.innerHeight;
      if (tour.on && !isSeen && document.activeElement === callout) callout.scrollIntoView({ block: "center" });
    }, later);
  }
}

function goTo() {
  updateTour();
  callout.focus({ preventScroll: true });
  bringIntoView();
}

/** Whoever has pressed what the tour asked for goes on with it; whoever is elsewhere is left there. */
function goOn() {
  const active = document.activeElement;
  const isThere = active === null || active === document.body || callout.contains(active) || placeOf("learn").contains(active);
  if (!isThere) return;
  callout.focus({ preventScroll: true });
  bringIntoView();
}

/** Beside what is to be pressed, where that is on a card. */
function put({ before, target }: Told) {
  const card = target === null ? null : (document.getElementById(target)?.closest("li.card") ?? null);
  if (card !== null) {
    if (card.firstChild !== callout) card.prepend(callout);
  } else if (callout.nextSibling !== before) before.before(callout);
}

/** Past what is to be looked at; past what is to be pressed, for those who do not want to. */
function advance() {
  if (tour.hasLooked) tour.isSkipped = true;
  tour.hasLooked = true;
  goTo();
}

function endTour() {
  tour.on = false;
  updateTour();
  document.getElementById("tour-start")?.focus();
}

function startTour() {
  Object.assign(tour, { on: true, hasLooked: false, isSkipped: false });
  goTo();
}

/** The button that begins it. */
export function tourStart() {
  return button("tour-start", "Guided tour", startTour, { "data-free": "" });
}

/** What the page shows has changed. */
export function updateTour() {
  for (const marked of document.querySelectorAll(".tour-target")) marked.classList.remove("tour-target");
  const start = document.getElementById("tour-start");
  if (start !== null) start.hidden = tour.on;
  if (!tour.on) {
    callout.remove();
    return;
  }
  const told = toldOf(stageNow());
  put(told);
  const isNew = title.textContent !== told.title;
  title.textContent = told.title;
  if (words.textContent !== told.words) words.textContent = told.words;
  const isEnd = told.before === placeOf("save");
  next.hidden = isEnd;
  next.textContent = tour.hasLooked ? "Skip to the end" : "Next";
  if (told.target !== null) document.getElementById(told.target)?.classList.add("tour-target");
  if (isNew) goOn();
}
