import assert from "node:assert/strict";
import { test } from "node:test";
import { bandColour, colouringOf, colourOf, instantAt, percentShort } from "../studio/arm_colours";
import { cursorTable, difference, markTable } from "../studio/arm_tables";
import { arm, armJoint } from "./samples";

test("TheErrorChoosesTheBand", () => {
  const { bands } = colouringOf("shown", arm());
  assert.equal(colourOf(4.9, bands, "light"), bandColour(0, "light"));
  assert.equal(colourOf(5, bands, "light"), bandColour(1, "light"));
  assert.equal(colourOf(49.9, bands, "dark"), bandColour(3, "dark"));
  assert.equal(colourOf(1000, bands, "dark"), bandColour(4, "dark"));
});

test("WhatIsNotKnownHasNoColourOfABand", () => {
  const { bands } = colouringOf("shown", arm());
  const none = colourOf(null, bands, "light");
  for (let band = 0; band < 5; ++band) assert.notEqual(none, bandColour(band, "light"));
});

test("EveryColouringTakesItsOwnNumber", () => {
  const data = arm({ over_bound: [[0.1, 0.2, 1.5]] });
  assert.equal(colouringOf("shown", data).value(data, 0, 2), 10);
  assert.equal(colouringOf("cursor", data).value(data, 0, 2), 60);
  assert.equal(colouringOf("bound", data).value(data, 0, 2), 1.5);
});

test("WithoutABoundNothingIsColouredByIt", () => {
  assert.equal(colouringOf("bound", arm()), colouringOf("shown", arm()));
});

test("SmallSharesHaveADecimalMore", () => {
  assert.equal(percentShort(9.94), "9.9\u202f%");
  assert.equal(percentShort(10.4), "10\u202f%");
  assert.equal(percentShort(null), "–");
});

test("TheNearestInstantIsShown", () => {
  const times = [0, 1, 2];
  assert.equal(instantAt(times, -5), 0);
  assert.equal(instantAt(times, 0.4), 0);
  assert.equal(instantAt(times, 0.6), 1);
  assert.equal(instantAt(times, 99), 2);
});

test("TheDifferenceIsBMinusA", () => {
  assert.equal(difference(2, 5), 3);
  assert.equal(difference(null, 5), null);
  assert.equal(difference(2, null), null);
});

test("AAndBAreComparedJointByJoint", () => {
  const [a, b] = [arm({ t_s: [0.5], error: [[1]] }), arm({ t_s: [2], error: [[4]] })];
  const table = markTable(arm(), { a, b }, 1, "error");
  assert.deepEqual(table.rows, [
    ["Time [s]", 1, 0.5, 2, 1.5],
    ["1. shoulder", 1, 1, 4, 3],
  ]);
  assert.equal(table.columns[1]?.unit, "N m");
});

test("JointsOfTwoUnitsHaveThemInTheirNames", () => {
  const slide = armJoint({ joint: 2, name: "slide", type: "prismatic", unit: "m", torque_unit: "N" });
  const both = arm({
    joints: [armJoint(), slide],
    position: [[0.1], [0.2]],
    error: [[1], [2]],
    percent: [[3], [4]],
    t_s: [0],
  });
  const { columns, rows } = cursorTable(both, 0);
  assert.equal(columns[1]?.unit, "");
  assert.deepEqual(rows, [
    ["1. shoulder [rad, N m]", 0.1, 1, 3],
    ["2. slide [m, N]", 0.2, 2, 4],
  ]);
});
