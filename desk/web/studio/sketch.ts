import type { Value } from "../report/document";
import { element } from "../report/element";
import type { Pair } from "../report/figure_type";
import { formatSignificant, withUnit } from "../report/format";
import type { PreviewSignal } from "./api";

/** A small picture of a curve, and of another that it should meet; its numbers stand beside it. */

/** Values over the time; a gap is null. */
export interface Curve {
  t_s: (number | null)[];
  values: (number | null)[];
}

interface Ends {
  low: number;
  high: number;
}

const kSketchWidth = 600;

const kSketchHeight = 100;

function svgElement(tag: string, attributes: Record<string, string>) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
}

/** What is shown: all of the curve, and of the other one as much as goes with it. */
export function sketchRange({ low, high }: Ends, other: Curve | null): Pair {
  const room = 4 * (high - low) || Math.abs(high) || 1;
  const known = other?.values.filter((each) => each !== null) ?? [];
  const theirs = other === null || other.values.length === 0 ? { low, high } : { low: Math.min(...known), high: Math.max(...known) };
  return [Math.min(low, Math.max(theirs.low, low - room)), Math.max(high, Math.min(theirs.high, high + room))];
}

export function sketchPath(t_s: Value[], values: Value[], [from, to]: Pair, [low, high]: Pair) {
  const x = (t: number) => ((kSketchWidth * (t - from)) / (to - from || 1)).toFixed(1);
  const y = (value: number) => (4 + ((kSketchHeight - 8) * (high - value)) / (high - low || 1)).toFixed(1);
  let path = "";
  let pen = "M";
  values.forEach((value, at) => {
    const t = t_s[at] ?? null;
    if (value === null || t === null) {
      pen = "M";
      return;
    }
    path += `${pen}${x(t)} ${y(value)}`;
    pen = "L";
  });
  return path;
}

/**
 * `signal` as it is read, `other` what it should meet.
 */
export function sketchElement(signal: PreviewSignal, other: Curve | null, name: string) {
  const root = element("div", { class: "sketch" });
  const { low, high } = signal;
  if (low === null || high === null) {
    root.append(element("p", { class: "empty" }, "No number in this column."));
    return root;
  }
  const number = (value: number) => withUnit(formatSignificant(value, 3), signal.unit);
  const words = `${name}: ${number(low)} to ${number(high)}`;
  const svg = svgElement("svg", {
    viewBox: `0 0 ${kSketchWidth} ${kSketchHeight}`,
    preserveAspectRatio: "none",
    role: "img",
    "aria-label": words,
  });
  const range = sketchRange({ low, high }, other);
  const ends: Pair = [signal.t_s[0] ?? 0, signal.t_s.at(-1) ?? 0];
  if (range[0] < 0 && range[1] > 0) {
    svg.append(svgElement("path", { class: "zero", d: sketchPath([...ends], [0, 0], ends, range) }));
  }
  svg.append(svgElement("path", { class: "own", d: sketchPath(signal.t_s, signal.values, ends, range) }));
  if (other !== null) svg.append(svgElement("path", { class: "other", d: sketchPath(other.t_s, other.values, ends, range) }));
  const scale = element("div", { class: "sketch-scale", "aria-hidden": "true" });
  scale.append(element("span", {}, number(range[1])), element("span", {}, number(range[0])));
  root.append(scale, svg);
  return root;
}

/** The lines of a sketch, said once for all of them. */
export function sketchLegend() {
  const line = (kind: string) => {
    const svg = svgElement("svg", { viewBox: "0 0 26 10", width: "26", height: "10", "aria-hidden": "true" });
    svg.append(svgElement("path", { class: kind, d: "M0 5L26 5" }));
    return svg;
  };
  const list = element("ul", { class: "sketch-legend" });
  list.append(
    element("li", {}, line("own"), "as it is read"),
    element("li", {}, line("other"), "to meet it: of a velocity the derivative of the position, of a torque the robot file's model"),
  );
  return list;
}
