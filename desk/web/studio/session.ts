import { itemAt } from "../report/lists";
import type { Errors, Explanation, Joint, State } from "./api";

/** What is looked at: joint and recording from 1; beside: another recording that is laid over it. */
export interface Looked {
  joint: number;
  recording: number;
  beside: number | null;
}

/** What a second "save" agrees to. */
export interface Agreed {
  accept_doubts?: boolean;
  replace?: boolean;
}

/** Under "save": what came of it, or what has to be confirmed; `name`: as the reader has typed it. */
interface Saving {
  words: string;
  level: "neutral" | "good" | "warn" | "bad";
  confirm: (() => void) | null;
  name: string | null;
}

export const look: Looked = { joint: 1, recording: 1, beside: null };

const kNoSearch: Explanation = { state: "none", doing: "", seconds: 0, error: "", revision: 0, answer: null };
const kNothingSaved: Saving = { words: "", level: "neutral", confirm: null, name: null };

/** What the server last said of the search, what is under way, and what was chosen last meanwhile. */
export const session: { found: Explanation; busy: boolean; wish: Partial<Looked> | null; saving: Saving } = {
  found: kNoSearch,
  busy: false,
  wish: null,
  saving: kNothingSaved,
};

export function forgetSaving() {
  session.saving = kNothingSaved;
}

let held: State | null = null;

/** What the server last said of the session. */
export function state(): State {
  if (held === null) throw new Error("there is no session yet");
  return held;
}

export function takeState(next: State) {
  held = next;
}

export function currentJoint(): Joint {
  return itemAt(state().joints, look.joint - 1);
}

/** The error that counts: on held-out data where it is known. */
export function errorOf(joint: Pick<Joint, "start" | "now">, when: "start" | "now"): number | null {
  const { held_out_percent, fitted_percent } = joint[when];
  return held_out_percent ?? fitted_percent;
}

/** What stands beside a joint's name, and how long its bar is. */
export interface RowNumbers {
  start: number | null;
  now: number | null;
  words: string;
}

/** `dragged`: the errors of a model that is off its fit; on fitted data where it says nothing of held-out ones. */
export function rowNumbers(joint: Pick<Joint, "start" | "now">, dragged: Errors | null): RowNumbers {
  if (dragged === null) return { start: errorOf(joint, "start"), now: errorOf(joint, "now"), words: "" };
  const { held_out_percent: heldOut, fitted_percent: fitted } = dragged;
  if (heldOut !== null) return { start: joint.start.held_out_percent, now: heldOut, words: " dragged" };
  return { start: joint.start.fitted_percent, now: fitted, words: " dragged, fitted" };
}

/** What a second "save" agrees to: first that a step is in doubt, then that a file is there. */
export function nextConfirm({ steps }: Pick<State, "steps">, agreed: Agreed): Agreed {
  const doubtful = steps.some((step) => step.doubts.length > 0);
  return doubtful && !agreed.accept_doubts ? { accept_doubts: true } : { ...agreed, replace: true };
}

/** The joint that is looked at first: the one with the largest error of those that move. */
export function worstJoint(joints: Joint[]): number {
  const error = (joint: Joint) => errorOf(joint, "now") ?? 0;
  const worst = joints.reduce((a, b) => (error(b) > error(a) && b.moves ? b : a));
  return worst.joint;
}
