import assert from "node:assert/strict";
import { test } from "node:test";
import { axisTitle, csvText, escapeHtml, formatNumber, formatSignificant, formatTick, withUnit } from "../report/format";
import { axis } from "./samples";

test("AGapIsADashWhateverItsFormat", () => {
  for (const format of ["d", ".2f", ".3g", ".1e"]) {
    assert.equal(formatNumber(null, format), "–");
    assert.equal(formatNumber(Number.NaN, format), "–");
    assert.equal(formatNumber(Number.POSITIVE_INFINITY, format), "–");
  }
});

test("DecimalsArePlacesBehindThePoint", () => {
  assert.equal(formatNumber(2.345678, ".2f"), "2.35");
  assert.equal(formatNumber(7, ".3f"), "7.000");
  assert.equal(formatNumber(41.6, "d"), "42");
});

test("NothingIsMinusZero", () => {
  assert.equal(formatNumber(-0.001, ".2f"), "0.00");
  assert.equal(formatNumber(-0.4, "d"), "0");
  assert.equal(formatNumber(-0.006, ".2f"), "-0.01");
});

test("SignificantDigitsLoseTheirZeros", () => {
  assert.equal(formatSignificant(0.5, 4), "0.5");
  assert.equal(formatSignificant(73.58, 4), "73.58");
  assert.equal(formatSignificant(0, 4), "0");
  assert.equal(formatSignificant(1234567, 3), "1.23e6");
  assert.equal(formatSignificant(123456, 3), "123456");
  assert.equal(formatSignificant(0.00001234, 3), "1.23e-5");
});

test("ANumberThatIsRoundedUpKeepsItsDigits", () => {
  assert.equal(formatSignificant(9.9996, 4), "10");
  assert.equal(formatSignificant(99999.9, 5), "100000");
});

test("PowersOfTenAreShort", () => {
  assert.equal(formatNumber(12345, ".2e"), "1.23e4");
  assert.equal(formatNumber(0.00012, ".1e"), "1.2e-4");
});

test("TicksOfAnAxisHoldNoRoundingErrors", () => {
  assert.equal(formatTick(0.1 + 0.2), "0.3");
});

test("WhatHasNoUnitIsShownWithout", () => {
  assert.equal(withUnit("3", "1"), "3");
  assert.equal(withUnit("3", ""), "3");
  assert.equal(withUnit("3", "rad/s"), "3 rad/s");
  assert.equal(axisTitle(axis({ unit: "1" })), "time [–]");
});

test("ANameIsNoMarkup", () => {
  assert.equal(escapeHtml(`<img src="x" alt='a&b'>`), "&lt;img src=&quot;x&quot; alt=&#39;a&amp;b&#39;&gt;");
});

test("AFieldOfACsvIsOneField", () => {
  const rows = [
    ["a,b", 'c"d', "e\nf"],
    [1.5, null, "g"],
  ];
  assert.equal(csvText(rows), '"a,b","c""d","e\nf"\n1.5,,g\n');
});
