import type { Value } from "../report/document";
import { formatNumber } from "../report/format";
import { itemAt } from "../report/lists";
import type { Arm } from "./api";

/** Bands of what colours a joint; the words are in the legend, the number stands at the joint. */
interface Bands {
  limits: number[];
  words: string[];
}

const kBands: Bands = {
  limits: [5, 10, 25, 50],
  words: ["below 5 %", "5 to 10 %", "10 to 25 %", "25 to 50 %", "50 % and more"],
};

const kBoundBands: Bands = {
  limits: [0.25, 0.5, 0.75, 1],
  words: ["below 0.25", "0.25 to 0.5", "0.5 to 0.75", "0.75 to 1", "beyond the bound"],
};

type Mode = "light" | "dark";

/* Brewer's YlOrBr: lightness alone tells the bands apart. */
const kBandColours: Record<Mode, string[]> = {
  light: ["#fff3c4", "#fed172", "#f28c28", "#b9500b", "#662506"],
  dark: ["#5b3a1e", "#94540f", "#d0751c", "#f7b04c", "#fff0b8"],
};

const kNoColour: Record<Mode, string> = { light: "#c3cbd3", dark: "#5d6975" };

/** What the joints are coloured by: the number of a joint, from 0, at an instant, and how it is written. */
interface Colouring {
  title: string;
  words: string;
  bands: Bands;
  value: (data: Arm, joint: number, instant: number) => Value;
  text: (value: Value) => string;
}

const kShown: Colouring = {
  title: "Error over the time shown",
  words: "Joint, and its rms error over the time shown as a share of the rms of its torque.",
  bands: kBands,
  value: (data, joint) => itemAt(data.joints, joint).error_percent,
  text: percentShort,
};

export const kColourings: Record<string, Colouring> = {
  shown: kShown,
  cursor: {
    title: "Error at the cursor",
    words: "Joint, and the size of its error at the cursor as a share of the rms of its torque.",
    bands: kBands,
    value: (data, joint, instant) => data.percent[joint]?.[instant] ?? null,
    text: percentShort,
  },
  bound: {
    title: "|e| / bound at the cursor",
    words: "Joint, and the size of its error at the cursor as a share of the bound in the robot file.",
    bands: kBoundBands,
    value: (data, joint, instant) => data.over_bound?.[joint]?.[instant] ?? null,
    text: (value) => formatNumber(value, ".2f"),
  },
};

export function percentShort(value: Value): string {
  return value === null ? "–" : `${formatNumber(value, value < 10 ? ".1f" : ".0f")}\u202f%`;
}

function bandOf(value: number, { limits }: Bands): number {
  return limits.filter((limit) => value >= limit).length;
}

/** The one of this name; without a bound in the robot file nothing is coloured by it. */
export function colouringOf(name: string, data: Arm): Colouring {
  const isThere = name !== "bound" || data.over_bound !== null;
  return (isThere ? kColourings[name] : undefined) ?? kShown;
}

/** The colour of a band. */
export function bandColour(band: number, mode: Mode): string {
  return itemAt(kBandColours[mode], band);
}

/** The colour of a number; null: there is none. */
export function colourOf(value: Value, bands: Bands, mode: Mode): string {
  return value === null ? kNoColour[mode] : bandColour(bandOf(value, bands), mode);
}

/** Number of the instant nearest to a time. */
export function instantAt(times: number[], time: number): number {
  const after = times.findIndex((each) => each >= time);
  if (after === -1) return times.length - 1;
  if (after === 0) return 0;
  return time - itemAt(times, after - 1) < itemAt(times, after) - time ? after - 1 : after;
}
