import type { Drawn } from "../report/document";
import { element, within } from "../report/element";
import type { Joint, QueryTo } from "./api";
import { showAlone } from "./charts";
import { choiceOf, type Choice } from "./choices";
import { replaceContent } from "./parts";
import { ask } from "./server";
import type { Looked } from "./session";
import type { TimeRange } from "./time_range";

type Variable = QueryTo<"GET", "/map">["x"];
type Over = QueryTo<"GET", "/spectrum">["over"];

/** A side of the map; joint null: of the one that is looked at. */
interface MapSide {
  variable: Variable;
  joint: number | null;
}

/** What a side of the map may be: the server's name for it, and the reader's. */
const kSides: [Variable, string][] = [
  ["position", "position"],
  ["velocity", "velocity"],
  ["acceleration", "acceleration"],
  ["load", "model torque"],
  ["since_reversal", "time since reversal"],
];

/** What the reader has chosen. */
const explored: { x: MapSide; y: MapSide; over: Over } = {
  x: { variable: "position", joint: null },
  y: { variable: "velocity", joint: null },
  over: "frequency",
};

/** Where map and spectrum stand, and where their choices. */
const explorePlaces = {
  map: { pictures: element("div", { class: "blocks" }), choice: element("div", { class: "choice-row" }) },
  spectrum: { pictures: element("div", { class: "blocks" }), choice: element("div", { class: "choice-row" }) },
};

function sideChoice(name: "x" | "y", label: string, joints: Joint[], redraw: () => void) {
  const side = explored[name];
  const row = choiceOf(`map-${name}`, label, kSides, side.variable, (value) => {
    side.variable = value as Variable;
    redraw();
  });
  if (joints.length < 2) return [row];
  const all: Choice[] = [["", "this joint"], ...joints.map(({ joint }): Choice => [String(joint), `joint ${joint}`])];
  const chosen = side.joint === null ? "" : String(side.joint);
  const other = choiceOf(`map-${name}-joint`, `of, ${label}`, all, chosen, (value) => {
    side.joint = value === "" ? null : Number(value);
    redraw();
  });
  within(other, "label").className = "hidden-text";
  return [row, other];
}

/** The place of map and spectrum; filled by drawExplored(). */
export function exploreElement() {
  const { map, spectrum } = explorePlaces;
  const part = ({ pictures, choice }: typeof map) => element("div", { class: "explored" }, choice, pictures);
  return element("div", { class: "explore" }, part(map), part(spectrum));
}

/** `slides`: the joint that is looked at has no turns. */
export function showExploreChoices(joints: Joint[], slides: boolean, redraw: () => void) {
  const { map, spectrum } = explorePlaces;
  replaceContent(map.choice, ...sideChoice("x", "Map over", joints, redraw), ...sideChoice("y", "and", joints, redraw));
  const overs: Choice[] = [
    ["frequency", "frequency"],
    ["order", slides ? "waves per metre of the joint" : "order: waves per turn of the joint"],
  ];
  replaceContent(
    spectrum.choice,
    choiceOf("spectrum-over", "Spectrum over", overs, explored.over, (value) => {
      explored.over = value as Over;
      redraw();
    }),
  );
}

/** What map and spectrum are asked for with. */
function exploredQueries({ joint, recording }: Looked, range: TimeRange | null) {
  const { x, y, over } = explored;
  const both = { joint, recording, ...range };
  return {
    map: {
      ...both,
      x: x.variable,
      y: y.variable,
      ...(x.joint === null ? {} : { x_joint: x.joint }),
      ...(y.joint === null ? {} : { y_joint: y.joint }),
    },
    spectrum: { ...both, over },
  };
}

/** Of several that are asked for, the last one is drawn. */
let exploredAsked = 0;

/** Map and spectrum of what is looked at. */
export async function drawExplored(look: Looked, range: TimeRange | null) {
  const own = ++exploredAsked;
  const queries = exploredQueries(look, range);
  const draw = async (name: "map" | "spectrum", question: Promise<{ chart: Drawn }>) => {
    const { chart } = await question;
    if (own === exploredAsked) showAlone(`${name}.0`, chart, explorePlaces[name].pictures);
  };
  // Each without the other: a refusal of one is said, and the other is there.
  const ends = await Promise.allSettled([
    draw("map", ask("GET", "/map", { query: queries.map })),
    draw("spectrum", ask("GET", "/spectrum", { query: queries.spectrum })),
  ]);
  for (const end of ends) if (end.status === "rejected") throw end.reason;
}

/** Another robot has other joints. */
export function forgetExploredJoints() {
  explored.x.joint = null;
  explored.y.joint = null;
}
