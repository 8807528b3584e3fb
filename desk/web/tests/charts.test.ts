import assert from "node:assert/strict";
import { test } from "node:test";
import { axisTip, itemTip, pointAt } from "../report/chart_tip";
import { chartCsv, chartNumbers, chartWords } from "../report/chart_words";
import { kLightLook, seriesColors, withOpacity } from "../report/palette";
import { drawable } from "../report/series";
import { rangeOf } from "../studio/time_range";
import { axis, chart, series } from "./samples";

test("TheNearestPointIsTold", () => {
  const one = series({ x: [0, 1, 2, 3], y: [0, 1, 2, 3] });
  assert.equal(pointAt(one, 1.4), 1);
  assert.equal(pointAt(one, 1.6), 2);
  assert.equal(pointAt(one, 5), -1);
});

test("AStepHoldsUntilTheNext", () => {
  const one = series({ kind: "steps", x: [0, 1, 2], y: [5, 6, 7] });
  assert.equal(pointAt(one, 1.9), 1);
  assert.equal(pointAt(one, 2), 2);
});

test("ATipTellsEverySeriesThatIsShownAndTheSpanThatItIsIn", () => {
  const one = chart({
    series: [series(), series({ name: "model", y: [4, 5, 6] })],
    spans: [{ from: 0.5, to: 1.5, label: "at rest", level: "neutral" }],
  });
  const tip = axisTip(one, ["#111111", "#222222"], 1, (name) => name !== "model");
  assert.match(tip, /measured<\/td><td>2 N m/);
  assert.doesNotMatch(tip, /model/);
  assert.match(tip, /at rest/);
});

test("ABarIsToldByItsTwoEdges", () => {
  const one = chart({ series: [series({ kind: "bars", x: [0, 1, 2], y: [3, 4] })] });
  assert.match(itemTip(one, ["#111111"], { seriesId: "s0", dataIndex: 1 }), /time 1 to 2 s/);
});

test("WhatALogarithmicAxisCannotShowIsAGap", () => {
  assert.equal(drawable(0, axis({ log: true })), null);
  assert.equal(drawable(0, axis()), 0);
});

test("FewPointsAreTheNumbersOfAChart", () => {
  const numbers = chartNumbers(chart({ series: [series(), series({ name: "model", y: [4, null, 6] })] }));
  assert.deepEqual(numbers.rows, [
    [0, 1, 4],
    [1, 2, null],
    [2, 3, 6],
  ]);
});

test("OfManyPointsTheEndsAreTold", () => {
  const x = Array.from({ length: 50 }, (_, at) => at);
  const numbers = chartNumbers(chart({ series: [series({ x, y: x.map((at) => (at === 7 ? -3 : at)) })] }));
  assert.deepEqual(numbers.rows, [["measured", 50, "-3 N m at 7 s", "49 N m at 49 s"]]);
});

test("ABandHasItsTwoEndsInTheCsv", () => {
  const band = series({ name: "range", kind: "band", x: [0], y: [1], y_upper: [2] });
  const csv = chartCsv(chart({ series: [band] }));
  assert.equal(csv, "range: time [s],range lower: torque [N m],range upper: torque [N m]\n0,1,2\n");
});

test("MarksAreSaidOfManyHowOften", () => {
  const span = { from: 1, to: 2, label: "at rest", level: "neutral" } as const;
  assert.match(chartWords(chart({ spans: [span] })), /at rest from 1 s to 2 s/);
  assert.match(chartWords(chart({ spans: Array.from({ length: 7 }, () => span) })), /at rest, 7 times/);
});

test("NoSeriesHasTheColourOfAnother", () => {
  const all = [series({ tone: "model" }), series({ tone: "auto" }), series({ tone: "auto" })];
  const colors = seriesColors(all, kLightLook);
  assert.equal(colors[0], kLightLook.tones.model);
  assert.equal(new Set(colors).size, 3);
});

test("AColourKeepsItsChannels", () => {
  assert.equal(withOpacity("#0072b2", 0.5), "rgba(0,114,178,0.5)");
});

test("AZoomOutToTheEndsIsNone", () => {
  assert.equal(rangeOf({ start: 0, end: 100, startValue: 0, endValue: 20 }), null);
  assert.deepEqual(rangeOf({ start: 10, end: 20, startValue: 2, endValue: 4 }), { from: 2, to: 4 });
  assert.equal(rangeOf({ start: 10, end: 10, startValue: 2, endValue: 2 }), null);
});
