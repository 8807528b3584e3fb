import assert from "node:assert/strict";
import { test } from "node:test";
import type { Heatmap } from "../report/document";
import { heatmapCells, heatmapNumbers, heatmapScale, roundNumbers } from "../report/heatmap";
import { waterfallFalls, waterfallWords } from "../report/waterfall";
import { sketchPath, sketchRange } from "../studio/sketch";
import { axis } from "./samples";

function map(change: Partial<Heatmap> = {}): Heatmap {
  const over = { x: axis({ name: "position" }), y: axis({ name: "velocity" }), value_axis: axis({ name: "error" }) };
  const cells = { x_edges: [0, 1, 2], y_edges: [0, 10, 20], value: [1, null, -3, 2] };
  return { type: "heatmap", title: "Error", ...over, ...cells, diverging: false, width: "half", note: "", ...change };
}

test("AnEmptyCellIsNone", () => {
  assert.deepEqual(heatmapCells(map()), [
    [0.5, 5, 1, 0, 0],
    [0.5, 15, -3, 0, 1],
    [1.5, 15, 2, 1, 1],
  ]);
});

test("SignedValuesHaveOneScaleBothWays", () => {
  assert.deepEqual(heatmapScale(map({ diverging: true })), { low: -3, high: 3 });
  assert.deepEqual(heatmapScale(map()), { low: -3, high: 2 });
});

test("AMapWithoutAValueHasAScale", () => {
  assert.deepEqual(heatmapScale(map({ value: [null, null, null, null] })), { low: 0, high: 1 });
  assert.deepEqual(heatmapScale(map({ value: [4, null, null, null] })), { low: 3.5, high: 4.5 });
});

test("TheEndsOfAMapAreToldInWords", () => {
  const { rows } = heatmapNumbers(map());
  assert.deepEqual(rows, [
    ["lowest", -3, 0.5, 15],
    ["highest", 2, 1.5, 15],
  ]);
});

test("AScaleHasRoundNumbers", () => {
  assert.deepEqual(roundNumbers(0, 10), [0, 2, 4, 6, 8, 10]);
  assert.deepEqual(roundNumbers(-3, 3), [-2, 0, 2]);
});

test("AStepTakesAwayWhatLiesBetweenItAndTheOneBefore", () => {
  const steps = [73.5, 11.25, null, 2.5].map((value, at) => ({ label: String(at), value }));
  assert.deepEqual(waterfallFalls(steps), [null, 62.25, null, null]);
});

test("AWaterfallIsSaidByItsEnds", () => {
  const steps = [
    { label: "as read", value: 73.58 },
    { label: "coulomb friction", value: 11.31 },
  ];
  const waterfall = { type: "waterfall", title: "", value_axis: axis({ name: "error", unit: "%" }), steps, levels: [] } as const;
  const words = waterfallWords({ ...waterfall, steps, levels: [], format: ".2f", width: "full", note: "" });
  assert.equal(words, "error [%] step by step: 2 steps, from as read 73.58 to coulomb friction 11.31.");
});

test("ACurveThatGoesFarBeyondTheOtherIsCutOff", () => {
  const range = sketchRange({ low: 0, high: 1 }, { t_s: [0, 1], values: [0.5, 1000] });
  assert.deepEqual(range, [0, 5]);
});

test("AGapLiftsThePen", () => {
  const path = sketchPath([0, 1, 2, 3], [0, null, 1, 1], [0, 3], [0, 1]);
  assert.equal(path, "M0.0 96.0M400.0 4.0L600.0 4.0");
});
