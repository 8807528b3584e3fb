"use strict";

/** `value` in a format of page.hpp: d, .Nf, .Ng, .Ne; a gap is shown as a dash. */
function formatNumber(value, format) {
  if (value === null || !Number.isFinite(value)) return "–";
  if (format === "d") return withoutNegativeZero(value.toFixed(0));
  const digits = Number(format.slice(1, -1));
  const style = format.slice(-1);
  if (style === "f") return withoutNegativeZero(value.toFixed(digits));
  if (style === "e") return shortExponent(value.toExponential(digits));
  return formatSignificant(value, digits);
}

function formatSignificant(value, digits) {
  if (value === 0) return "0";
  const rounded = value.toExponential(digits - 1);
  const exponent = Number(rounded.split("e")[1]);
  if (exponent < -4 || exponent >= Math.max(digits, 6)) {
    const [mantissa, power] = rounded.split("e");
    return `${withoutTrailingZeros(mantissa)}e${Number(power)}`;
  }
  return withoutTrailingZeros(value.toFixed(Math.max(0, digits - 1 - exponent)));
}

function withoutTrailingZeros(text) {
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

function withoutNegativeZero(text) {
  return /^-[0.]+$/.test(text) ? text.slice(1) : text;
}

function shortExponent(text) {
  return text.replace("e+", "e");
}

function formatTick(value) {
  return formatSignificant(value, 7);
}

function unitInBrackets(unit) {
  return unit === "1" ? "[–]" : `[${unit}]`;
}

function withUnit(text, unit) {
  return unit === "" || unit === "1" ? text : `${text} ${unit}`;
}

function axisTitle(axis) {
  return `${axis.name} ${unitInBrackets(axis.unit)}`;
}

function escapeHtml(text) {
  const names = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&#39;" };
  return text.replace(/[&<>"']/g, (character) => names[character]);
}

/** A field of a CSV file. */
function csvField(value) {
  if (value === null || value === undefined) return "";
  const text = String(value);
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

function csvText(rows) {
  return rows.map((row) => row.map(csvField).join(",")).join("\n") + "\n";
}
