import type { EffectAt, Explanation, State } from "./api";

type EffectOn = Pick<EffectAt, "effect" | "joint">;

/** An effect that the tour asks for, and its button in the answer of the search. */
export interface TourEffect extends EffectOn {
  id: string;
}

/** Where the tour is; clicks count from 1, and how many there are is known once the search has ended. */
export type TourStage =
  | { part: "search"; click: 1 }
  | { part: "wait" }
  | { part: "add"; click: number; clicks: number; next: TourEffect }
  | { part: "end"; came: TourEnd };

/** What there is to say at the end: also to those who skipped there. */
export type TourEnd = "added" | "nothing found" | "not added" | "searching" | "not searched";

/** What the search has named, in its order; where it tells none of them from another one, the first of each. */
function namedBy({ answer }: Explanation): TourEffect[] {
  const joints = answer?.joints ?? [];
  const alone = joints.flatMap(({ joint, cards }) => cards.map((card, at): TourEffect => ({ effect: card.effect, joint: card.joint, id: `add-${joint}-${at}` })));
  if (alone.length > 0) return alone;
  return joints.flatMap(({ joint, classes }) =>
    classes.flatMap(({ effects }, at) => effects.slice(0, 1).map(({ effect, joint: of }): TourEffect => ({ effect, joint: of, id: `add-${joint}-class-${at}-0` }))),
  );
}

export function endOf(found: Explanation, { steps }: Pick<State, "steps">): TourEnd {
  if (steps.length > 0) return "added";
  if (found.state === "running") return "searching";
  if (found.state !== "done" || found.answer === null) return "not searched";
  return namedBy(found).length === 0 ? "nothing found" : "not added";
}

/** Told from what there is: whoever goes another way than the tour says is not led astray. */
export function stageOf(found: Explanation, state: Pick<State, "steps">): TourStage {
  if (found.state === "running") return { part: "wait" };
  if (found.state !== "done" || found.answer === null) return { part: "search", click: 1 };
  const named = namedBy(found);
  const isAdded = (what: EffectOn) => state.steps.some(({ effect, joint }) => effect === what.effect && joint === what.joint);
  const added = named.filter(isAdded).length;
  const next = named.find((each) => !isAdded(each));
  if (next === undefined) return { part: "end", came: endOf(found, state) };
  return { part: "add", click: added + 2, clicks: named.length + 1, next };
}
