import type { State } from "./api";
import { baseName, foldWith, noteWith } from "./parts";

/** As many stand open above the charts; more are folded up. */
const kMostOpen = 3;

type Recorded = Pick<State["recordings"][number], "name" | "remarks">;

/** What the reader of the recordings has to say of each: what it left out, filled in or took for what. */
export function remarkWords(recordings: Recorded[]): string[] {
  return recordings.flatMap(({ name, remarks }) => (remarks.length === 0 ? [] : [`${baseName(name)}: ${remarks.join("; ")}`]));
}

export function remarkNotes(recordings: Recorded[]): HTMLElement[] {
  const notes = remarkWords(recordings).map((words) => noteWith("neutral", words));
  const count = recordings.reduce((sum, { remarks }) => sum + remarks.length, 0);
  if (count <= kMostOpen) return notes;
  const fold = foldWith("remarks", `What was noted when the recordings were read (${count})`);
  fold.append(...notes);
  return [fold];
}
