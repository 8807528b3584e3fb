/** A small picture of a curve, and of another that it should meet; its numbers stand beside it. */

const kSketchWidth = 600;
const kSketchHeight = 100;

function svgElement(tag, attributes) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
}

/** What is shown: all of the curve, and of the other one as much as goes with it. */
function sketchRange({ low, high }, other) {
  const room = 4 * (high - low) || Math.abs(high) || 1;
  const within = (values, ends) => Math[ends](...values.filter((each) => each !== null));
  const theirs = other === null || other.values.length === 0 ? [low, high] : [within(other.values, "min"), within(other.values, "max")];
  return [Math.min(low, Math.max(theirs[0], low - room)), Math.max(high, Math.min(theirs[1], high + room))];
}

function sketchPath(t_s, values, [from, to], [low, high]) {
  const x = (t) => ((kSketchWidth * (t - from)) / (to - from || 1)).toFixed(1);
  const y = (value) => (4 + ((kSketchHeight - 8) * (high - value)) / (high - low || 1)).toFixed(1);
  let path = "";
  let pen = "M";
  values.forEach((value, at) => {
    if (value === null || t_s[at] === null) {
      pen = "M";
      return;
    }
    path += `${pen}${x(t_s[at])} ${y(value)}`;
    pen = "L";
  });
  return path;
}

/**
 * @param {{t_s: number[], values: number[], low: number | null, high: number | null, unit: string}} signal
 * @param {{t_s: number[], values: number[]} | null} other
 * @param {string} name
 */
function sketchElement(signal, other, name) {
  const root = element("div", { class: "sketch" });
  if (signal.low === null) {
    root.append(element("p", { class: "empty" }, "No number in this column."));
    return root;
  }
  const number = (value) => withUnit(formatSignificant(value, 3), signal.unit);
  const words = `${name}: ${number(signal.low)} to ${number(signal.high)}`;
  const svg = svgElement("svg", {
    viewBox: `0 0 ${kSketchWidth} ${kSketchHeight}`,
    preserveAspectRatio: "none",
    role: "img",
    "aria-label": words,
  });
  const range = sketchRange(signal, other);
  const ends = [signal.t_s[0], signal.t_s.at(-1)];
  if (range[0] < 0 && range[1] > 0) {
    svg.append(svgElement("path", { class: "zero", d: sketchPath(ends, [0, 0], ends, range) }));
  }
  svg.append(svgElement("path", { class: "own", d: sketchPath(signal.t_s, signal.values, ends, range) }));
  if (other !== null) svg.append(svgElement("path", { class: "other", d: sketchPath(other.t_s, other.values, ends, range) }));
  const scale = element("div", { class: "sketch-scale", "aria-hidden": "true" });
  scale.append(element("span", {}, number(range[1])), element("span", {}, number(range[0])));
  root.append(scale, svg);
  return root;
}

/** The lines of a sketch, said once for all of them. */
function sketchLegend() {
  const line = (kind) => {
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
