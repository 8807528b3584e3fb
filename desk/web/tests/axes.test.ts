import assert from "node:assert/strict";
import { test } from "node:test";
import { edgeLabels, labelStep } from "../report/axes";
import { xExtent } from "../report/chart";
import { chart, axis, series } from "./samples";

test("LabelsStandAtRoundSteps", () => {
  assert.equal(labelStep(10, 5), 2);
  assert.equal(labelStep(100, 10), 10);
  assert.equal(labelStep(12, 10), 1);
  assert.equal(labelStep(28, 10), 3);
  assert.equal(labelStep(75, 10), 10);
});

test("AnEndIsLabelledWhereItFallsInWithTheOthers", () => {
  assert.deepEqual(edgeLabels(0, 10, 5, false), { showMinLabel: true, showMaxLabel: true });
  assert.deepEqual(edgeLabels(0.37, 10, 5, false), { showMinLabel: false, showMaxLabel: true });
});

test("ALogarithmicAxisLabelsPowersOfTenAtItsEnds", () => {
  assert.deepEqual(edgeLabels(0.01, 30, 5, true), { showMinLabel: true, showMaxLabel: false });
});

test("TwentySecondsButASampleAreTwentySeconds", () => {
  const one = chart({ series: [series({ x: [0, 10, 19.999] })] });
  assert.deepEqual(xExtent([one]), { low: 0, high: 20 });
});

test("AnEndThatIsNotNearlyRoundStays", () => {
  const one = chart({ series: [series({ x: [0.37, 10, 19.1] })] });
  assert.deepEqual(xExtent([one]), { low: 0.37, high: 19.1 });
});

test("ChartsOfAGroupShareTheirEnds", () => {
  const first = chart({ series: [series({ x: [0, 5] })] });
  const second = chart({ series: [series({ x: [2, 8] })], events: [{ x: 9, label: "fault", level: "bad" }] });
  assert.deepEqual(xExtent([first, second]), { low: 0, high: 9 });
});

test("WhatALogarithmicAxisCannotShowIsLeftOut", () => {
  const one = chart({ x: axis({ log: true }), series: [series({ x: [0, 0.1, 7] })] });
  assert.deepEqual(xExtent([one]), { low: 0.1, high: 7 });
});

test("WithoutTwoPlacesThereIsNoRange", () => {
  assert.equal(xExtent([chart({ series: [series({ x: [3], y: [1] })] })]), null);
});
