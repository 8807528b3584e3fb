import assert from "node:assert/strict";
import { test } from "node:test";
import { checkAnswer } from "../studio/answers";
import { arm, chart } from "./samples";

const waterfall = {
  type: "waterfall",
  title: "What the steps take away",
  value_axis: { name: "error", unit: "%", log: false, min: 0, max: null },
  steps: [{ label: "as read", value: 73.58 }],
  levels: [],
  format: ".2f",
  width: "full",
  note: "",
};

function charts() {
  return { revision: 3, charts: [chart(), chart(), chart(), chart()], waterfall };
}

/** Whether it is taken, or how it is refused. */
function refusal(check: () => unknown): string {
  try {
    check();
    return "";
  } catch (error) {
    return (error as Error).message;
  }
}

test("AnAnswerAsAgreedIsTaken", () => {
  const answer = charts();
  assert.equal(checkAnswer("GET", "/charts", answer), answer);
  assert.doesNotThrow(() => checkAnswer("GET", "/arm", arm()));
});

test("AWrongTypeIsRefusedWithItsPlace", () => {
  const answer = charts();
  const wrong = { ...answer, charts: answer.charts.map((each, at) => (at === 2 ? { ...each, title: 7 } : each)) };
  const words = refusal(() => checkAnswer("GET", "/charts", wrong));
  assert.match(words, /GET \/charts/);
  assert.match(words, /\/charts\/2\/title is not of the type string/);
});

test("ANumberAmongNumbersThatIsNoneIsFound", () => {
  const answer = arm();
  answer.error = [[0, "1" as unknown as number, 2]];
  assert.match(refusal(() => checkAnswer("GET", "/arm", answer)), /\/error\/0\/1 is not of the type/);
});

test("WhatIsMissingIsNamed", () => {
  const { revision: _, ...rest } = charts();
  assert.match(refusal(() => checkAnswer("GET", "/charts", rest)), /the whole of it lacks "revision"/);
});

test("WhatIsUnknownIsNamed", () => {
  const words = refusal(() => checkAnswer("GET", "/charts", { ...charts(), colour: "red" }));
  assert.match(words, /has "colour", which is unknown/);
});

test("AValueThatIsUnknownIsRefused", () => {
  const answer = { ...charts(), waterfall: { ...waterfall, width: "third" } };
  assert.match(refusal(() => checkAnswer("GET", "/charts", answer)), /\/waterfall\/width has a value that is unknown/);
});

test("OfSeveralFormsTheNearestIsMeant", () => {
  const section = { heading: "What was seen", text: "", recording: "", blocks: [{ ...chart(), note: 3 }] };
  const words = refusal(() => checkAnswer("GET", "/results/figures", { sections: [section] }));
  assert.match(words, /\/sections\/0\/blocks\/0\/note is not of the type string/);
});

test("NoAnswerIsNoAnswer", () => {
  assert.notEqual(refusal(() => checkAnswer("GET", "/state", null)), "");
  assert.notEqual(refusal(() => checkAnswer("GET", "/live", { source: "sil", loaded: true })), "");
});
