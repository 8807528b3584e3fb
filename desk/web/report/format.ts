import type { Axis, Cell, Value } from "./document";

/** `value` in a format of page.hpp: d, .Nf, .Ng, .Ne; a gap is shown as a dash. */
export function formatNumber(value: Value, format: string): string {
  if (value === null || !Number.isFinite(value)) return "–";
  if (format === "d") return withoutNegativeZero(value.toFixed(0));
  const digits = Number(format.slice(1, -1));
  const style = format.slice(-1);
  if (style === "f") return withoutNegativeZero(value.toFixed(digits));
  if (style === "e") return shortExponent(value.toExponential(digits));
  return formatSignificant(value, digits);
}

export function formatSignificant(value: number, digits: number) {
  if (value === 0) return "0";
  const rounded = value.toExponential(digits - 1);
  const [mantissa = "", power = ""] = rounded.split("e");
  const exponent = Number(power);
  if (exponent < -4 || exponent >= Math.max(digits, 6)) return `${withoutTrailingZeros(mantissa)}e${exponent}`;
  return withoutTrailingZeros(value.toFixed(Math.max(0, digits - 1 - exponent)));
}

function withoutTrailingZeros(text: string) {
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

function withoutNegativeZero(text: string) {
  return /^-[0.]+$/.test(text) ? text.slice(1) : text;
}

function shortExponent(text: string) {
  return text.replace("e+", "e");
}

export function formatTick(value: number) {
  return formatSignificant(value, 7);
}

export function unitInBrackets(unit: string) {
  return unit === "1" ? "[–]" : `[${unit}]`;
}

export function withUnit(text: string, unit: string) {
  return unit === "" || unit === "1" ? text : `${text} ${unit}`;
}

export function axisTitle(axis: Axis) {
  return `${axis.name} ${unitInBrackets(axis.unit)}`;
}

export function escapeHtml(text: string) {
  const names: Record<string, string> = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&#39;" };
  return text.replace(/[&<>"']/g, (character) => names[character] ?? character);
}

/** A field of a CSV file. */
function csvField(value: Cell | undefined) {
  if (value === null || value === undefined) return "";
  const text = String(value);
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

export function csvText(rows: (Cell | undefined)[][]) {
  return rows.map((row) => row.map(csvField).join(",")).join("\n") + "\n";
}
