import type { Figure } from "../report/figure_type";
import type { LiveSetup, Moment } from "./api";
import { LivePicture } from "./live_charts";
import type { LiveCurve } from "./live_curves";

/** What there is of a live view. */
export const live: {
  setup: LiveSetup | null;
  now: Moment | null;
  /** From which step on the server is asked. */
  next: number;
  curves: LiveCurve[];
  picture: LivePicture | null;
  numbersAt: number;
  /** When the last pictures were drawn, ms. */
  pictures: number[];
  /** The number of the detection whose surroundings are drawn. */
  shown: number;
  /** And of the one that was said aloud. */
  told: number;
  saved: string;
  frozen: Figure[];
  fillTable: ((now: Moment) => void) | null;
  /** `isOwn`: this page has asked for it, and shows it. */
  onLoaded: (isOwn: boolean) => Promise<void>;
  /** The number of the session that this page shows or is about to; null: it has not heard of it yet. */
  session: number | null;
  /** What stands on the page now, as text: it is written anew only where it says something else. */
  written: { faults: string; detection: string; recording: string; complaint: string };
} = {
  setup: null,
  now: null,
  next: 0,
  curves: [],
  picture: null,
  numbersAt: 0,
  pictures: [],
  shown: 0,
  told: 0,
  saved: "",
  frozen: [],
  fillTable: null,
  onLoaded: async () => {},
  session: null,
  written: { faults: "", detection: "", recording: "", complaint: "" },
};

export function liveSetup(): LiveSetup {
  if (live.setup === null) throw new Error("there is no live view");
  return live.setup;
}

export function isBench() {
  return liveSetup().source === "sil";
}

export function jointName(joint: number) {
  return `joint ${joint} (${liveSetup().joints[joint - 1]})`;
}
