import assert from "node:assert/strict";
import { test } from "node:test";
import type { Joint } from "../studio/api";
import { steppedBy } from "../studio/drag";
import { isRobotFile, sizeWords } from "../studio/files";
import { appendSteps, emptyCurves, liveScale } from "../studio/live_curves";
import { sizeFrom } from "../studio/live_size";
import { remarkWords } from "../studio/remarks";
import { errorOf, nextConfirm, rowNumbers, worstJoint } from "../studio/session";
import { columnOptions, editOf, signalWords } from "../studio/signals";
import { laterWords, valueWords, withPlainNames } from "../studio/parts";
import { step } from "./samples";

function joint(number: number, now: number | null, moves = true): Joint {
  const errors = (value: number | null) => ({ fitted_percent: 50, held_out_percent: value });
  return { joint: number, name: "", unit: "N m", moves, start: errors(90), now: errors(now), effects: [] };
}

test("HeldOutDataCountWhereTheyAreKnown", () => {
  assert.equal(errorOf(joint(1, 7), "now"), 7);
  assert.equal(errorOf(joint(1, null), "now"), 50);
});

test("TheJointWithTheLargestErrorOfThoseThatMoveIsLookedAtFirst", () => {
  assert.equal(worstJoint([joint(1, 3), joint(2, 9), joint(3, 80, false)]), 2);
});

test("SavingAgreesToDoubtsFirstAndToReplacingThen", () => {
  const doubtful = { steps: [step({ doubts: ["the held-out error does not fall"] })] };
  const first = nextConfirm(doubtful, {});
  assert.deepEqual(first, { accept_doubts: true });
  assert.deepEqual(nextConfirm(doubtful, first), { accept_doubts: true, replace: true });
  assert.deepEqual(nextConfirm({ steps: [step()] }, {}), { replace: true });
});

test("AnArrowDragsByAHundredthAndNoFurtherThanItGoes", () => {
  const range = { value: 5, low: 0, high: 10 };
  assert.equal(steppedBy("ArrowRight", 5, range), 5.1);
  assert.equal(steppedBy("ArrowDown", 5, range), 4.9);
  assert.equal(steppedBy("ArrowUp", 10, range), 10);
  assert.equal(steppedBy("ArrowLeft", 0.05, range), 0);
  assert.equal(steppedBy("a", 5, range), null);
});

test("AFittedNumberIsToldWithItsIntervalOrWhyItHasNone", () => {
  assert.equal(valueWords({ value: 20.8, unit: "N", ci95: [19.6, 22] }), "20.8 N, 95 % between 19.6 and 22");
  assert.equal(valueWords({ value: 5, unit: "N", ci95: [4.99998, 5.00002] }), "5 N, 95 % between 4.99998 and 5.00002");
  const without = { value: 0.5, unit: "1", ci95: null, why_no_ci95: "two of three blocks" };
  assert.equal(valueWords(without), "0.5, no interval: two of three blocks");
});

test("WhatTheReaderNotedIsToldOfEveryRecording", () => {
  const told = remarkWords([
    { name: "runs/a.csv", remarks: ["200 rows were left out", "column time is the time t"] },
    { name: "b.csv", remarks: [] },
  ]);
  assert.deepEqual(told, ["a.csv: 200 rows were left out; column time is the time t"]);
});

test("AnEmptyOrUnreadableSizeOfAFaultIsNone", () => {
  const range = { least: -1000, most: 1000, unit: "N m" };
  assert.equal(sizeFrom("-2.5", range), -2.5);
  for (const text of ["", " ", "x", "1e999"]) assert.match(String(sizeFrom(text, range)), /no number: it has to be -1000 to 1000 N m/);
  assert.match(String(sizeFrom("0", range)), /0 is no fault/);
});

test("TheListOfJointsFollowsANumberThatIsDragged", () => {
  const now = { start: { fitted_percent: 50, held_out_percent: 60 }, now: { fitted_percent: 5, held_out_percent: 6 } };
  assert.deepEqual(rowNumbers(now, null), { start: 60, now: 6, words: "" });
  assert.deepEqual(rowNumbers(now, { fitted_percent: 7, held_out_percent: 8 }), { start: 60, now: 8, words: " dragged" });
  const fitted = { fitted_percent: 7, held_out_percent: null };
  assert.deepEqual(rowNumbers(now, fitted), { start: 50, now: 7, words: " dragged, fitted" });
});

test("AnEffectIsCalledByItsPlainNameInTheWordsOfTheSearch", () => {
  const effects = ["coulomb_friction", "backlash"];
  assert.equal(withPlainNames("joint 1: coulomb_friction is missing, coulomb_frictions not", effects), "joint 1: coulomb friction is missing, coulomb_frictions not");
  assert.equal(withPlainNames("a_b", []), "a_b");
});

test("RobotFilesAreKnownByTheirEnding", () => {
  assert.ok(isRobotFile("Arm.TOML") && isRobotFile("arm.urdf"));
  assert.ok(!isRobotFile("run.csv"));
});

test("SizesAreToldInTheirLargestUnit", () => {
  assert.equal(sizeWords(0), "0 bytes");
  assert.equal(sizeWords(1023), "1023 bytes");
  assert.equal(sizeWords(1024), "1 KiB");
  assert.equal(sizeWords(25 * 1024 * 1024), "25 MiB");
  assert.equal(sizeWords(5000 * 1024 ** 3), "5000 GiB");
});

const torque = {
  quantity: "torque",
  joint: 2,
  source: "",
  unit: "N m",
  units: ["N m"],
  scale: 1,
  of: "joint",
  sides: ["joint"],
  file: null,
  offset_s: null,
  more: "",
} as const;

test("AColumnIsChosenOfThoseThatAreThere", () => {
  const signal = { ...torque, units: [...torque.units], sides: [...torque.sides] };
  assert.deepEqual(columnOptions(signal, ["tau"]), [
    ["", "choose a column"],
    ["tau", "tau"],
  ]);
  assert.deepEqual(columnOptions({ ...signal, source: "gone" }, ["tau"]), [
    ["tau", "tau"],
    ["gone", "gone (not there)"],
  ]);
  assert.deepEqual(columnOptions({ ...signal, quantity: "velocity", source: "v" }, ["v"])[0], ["", "derived"]);
});

test("AnEditSaysWhichSignalItIsOf", () => {
  assert.deepEqual(editOf({ quantity: "torque", joint: 2 }, { scale: -1 }), { quantity: "torque", joint: 2, scale: -1 });
  assert.deepEqual(editOf({ quantity: "time", joint: null }, { source: "t" }), { quantity: "time", source: "t" });
  assert.deepEqual(editOf({ quantity: "time", joint: null, file: 2 }, { offset_s: 3 }), { quantity: "time", file: 2, offset_s: 3 });
  assert.equal(signalWords({ quantity: "torque", joint: 2 }), "the torque of joint 2");
  assert.equal(signalWords({ quantity: "time", joint: null, file: 1 }), "the time");
  assert.equal(signalWords({ quantity: "time", joint: null, file: 2 }), "the time of file 2");
});

function steps(t_s: number[], values: (number | null)[]) {
  return { first: 0, next: t_s.length, t_s, low: [values], high: [values], threshold: [values], act: [] };
}

test("StepsThatAreMissingBreakTheCurve", () => {
  const curves = emptyCurves(1);
  appendSteps(curves, steps([0, 0.02, 1], [1, 2, 3]), 0.02);
  assert.deepEqual(curves[0]?.threshold, [
    [0, 1],
    [0.02, 2],
    [0.04, null],
    [1, 3],
  ]);
});

test("WhatHasLeftTheWindowIsForgotten", () => {
  const curves = emptyCurves(1);
  appendSteps(curves, steps([0, 5], [1, 1]), 0.02);
  appendSteps(curves, steps([14], [1]), 0.02);
  const times = curves[0]?.threshold.map(([t]) => t) ?? [];
  assert.deepEqual(times, [5, 5.02, 14]);
});

test("OfTwoLevelsTheSecondHasACurveToo", () => {
  const curves = emptyCurves(1);
  appendSteps(curves, { ...steps([0, 0.02, 1], [1, 2, 3]), act: [[3, 6, 9]] }, 0.02);
  assert.deepEqual(curves[0]?.act, [
    [0, 3],
    [0.02, 6],
    [0.04, null],
    [1, 9],
  ]);
  assert.ok(liveScale(curves[0]).top >= 9);
  const ofOne = emptyCurves(1);
  appendSteps(ofOne, { ...steps([0, 0.02], [1, 2]), act: [] }, 0.02);
  assert.deepEqual(ofOne[0]?.act, []);
});

test("TheScaleReachesBeyondTheHighestValue", () => {
  const { top, step: width } = liveScale({ residual: [[0, 0.4]], threshold: [[0, 1.9]], act: [] });
  assert.ok(top >= 1.9 && top / width === Math.round(top / width));
});

test("ANumberThatALaterStepHasFittedAgainSaysWhatItIsNow", () => {
  const level = { value: 41.447, unit: "N", ci95: [35.46, 47.45], why_no_ci95: "" };
  assert.match(laterWords(level, 20.8012), /^; now 20\.8\sN, fitted again with a later step$/);
  assert.equal(laterWords(level, 41.4471), "");
  assert.equal(laterWords(level, undefined), "");
});
