import { element, type Attributes } from "../report/element";

/** Parts of the page that are filled anew again and again, each by its name. */
type PlaceName =
  | "charts"
  | "desk"
  | "detection"
  | "effects"
  | "fall"
  | "frozen"
  | "head"
  | "headline"
  | "injected"
  | "joints"
  | "learn"
  | "live"
  | "liveMessage"
  | "liveNumbers"
  | "livePicture"
  | "liveStatus"
  | "load"
  | "loadDoing"
  | "loadMap"
  | "loadMessage"
  | "loadNotes"
  | "loadSteps"
  | "message"
  | "recording"
  | "recordingRow"
  | "results"
  | "resultsDoing"
  | "resultsFigures"
  | "resultsMessage"
  | "resultsRuns"
  | "run"
  | "watched"
  | "save"
  | "steps";

const places = new Map<PlaceName, HTMLElement>();

/** Makes the place. */
export function place(name: PlaceName, attributes: Attributes = {}): HTMLElement {
  const made = element("div", { id: `place-${name}`, ...attributes });
  places.set(name, made);
  return made;
}

/** The place that was made. */
export function placeOf(name: PlaceName): HTMLElement {
  const made = places.get(name);
  if (made === undefined) throw new Error(`the page has no place ${name}`);
  return made;
}
