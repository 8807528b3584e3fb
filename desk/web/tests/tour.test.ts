import assert from "node:assert/strict";
import { test } from "node:test";
import type { Explanation, State } from "../studio/api";
import { endOf, stageOf } from "../studio/tour_stage";

/** As much of an answer as the tour reads. */
function found(joints: object[]): Explanation {
  return { state: "done", doing: "", seconds: 1, error: "", revision: 0, answer: { joints } } as unknown as Explanation;
}

function steps(...all: [string, number][]): Pick<State, "steps"> {
  return { steps: all.map(([effect, joint]) => ({ effect, joint })) as State["steps"] };
}

const emps = found([
  {
    joint: 1,
    cards: [
      { effect: "coulomb_friction", joint: 1 },
      { effect: "viscous_friction", joint: 1 },
      { effect: "friction_asymmetry", joint: 1 },
    ],
    classes: [],
  },
]);

test("ATourOfThreeEffectsHasFourClicks", () => {
  const none = { ...emps, state: "none", answer: null } as Explanation;
  assert.deepEqual(stageOf(none, steps()), { part: "search", click: 1 });
  assert.deepEqual(stageOf({ ...none, state: "running" }, steps()), { part: "wait" });
  assert.deepEqual(stageOf(emps, steps()), { part: "add", click: 2, clicks: 4, next: { effect: "coulomb_friction", joint: 1, id: "add-1-0" } });
  const two = steps(["coulomb_friction", 1], ["viscous_friction", 1]);
  assert.deepEqual(stageOf(emps, two), { part: "add", click: 4, clicks: 4, next: { effect: "friction_asymmetry", joint: 1, id: "add-1-2" } });
  assert.deepEqual(stageOf(emps, steps(["coulomb_friction", 1], ["viscous_friction", 1], ["friction_asymmetry", 1])), { part: "end", came: "added" });
});

test("ATourGoesOnFromWhatIsThereAndNamesOneOfThoseThatAreNotToldApart", () => {
  assert.equal(stageOf({ ...emps, state: "stopped" } as Explanation, steps()).part, "search");
  const other = stageOf(emps, steps(["viscous_friction", 1], ["torque_offset", 1]));
  assert.equal(other.part === "add" && other.next.id, "add-1-0");
  assert.deepEqual(stageOf(found([]), steps()), { part: "end", came: "nothing found" });
  const either = found([{ joint: 2, cards: [], classes: [{ effects: [{ effect: "link_mass", joint: 3 }, { effect: "tip_payload", joint: 3 }] }] }]);
  assert.deepEqual(stageOf(either, steps()), { part: "add", click: 2, clicks: 2, next: { effect: "link_mass", joint: 3, id: "add-2-class-0-0" } });
});

test("ATourThatWasSkippedSaysWhatCameOfIt", () => {
  const unsearched = { ...emps, state: "none", answer: null } as Explanation;
  assert.equal(endOf(unsearched, steps()), "not searched");
  assert.equal(endOf({ ...unsearched, state: "stopped" }, steps()), "not searched");
  assert.equal(endOf({ ...unsearched, state: "running" }, steps()), "searching");
  assert.equal(endOf(emps, steps()), "not added");
  assert.equal(endOf(found([]), steps()), "nothing found");
  assert.equal(endOf(unsearched, steps(["backlash", 1])), "added");
});
