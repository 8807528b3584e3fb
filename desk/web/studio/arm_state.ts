import { element } from "../report/element";
import type { Arm } from "./api";
import { ArmView } from "./arm_view";

/**
 * The picture of the arm: the last answer of the server, the drawing (null: none yet, or none in this browser), the
 * number of the instant that is shown.
 */
export const arm: { data: Arm | null; view: ArmView | null; instant: number; asked: number; playing: number | null } = {
  data: null,
  view: null,
  instant: 0,
  asked: 0,
  playing: null,
};

/** What stands beside the picture, and is filled as it moves. */
export const armParts = {
  title: element("h3", { id: "arm-title" }, "The arm"),
  host: element("div", {
    id: "arm-view",
    class: "arm-view",
    role: "application",
    tabindex: "0",
    "aria-roledescription": "3-D view",
    "aria-label": "The arm",
    "aria-describedby": "arm-words arm-keys",
  }),
  labels: element("div", { class: "arm-labels", "aria-hidden": "true" }),
  slider: element("input", { type: "range", id: "arm-time", min: "0", step: "1", "aria-label": "Time" }),
  time: element("output", { for: "arm-time", class: "arm-time" }, "–"),
  colours: element("select", { id: "arm-colours" }),
  centres: element("input", { type: "checkbox", id: "arm-centres" }),
  legend: element("ul", { class: "bands", "aria-labelledby": "arm-legend-words" }),
  words: element("p", { class: "remark", id: "arm-legend-words" }),
  table: element("div", { id: "arm-table" }),
  quantity: element("select", { id: "arm-quantity" }),
  marks: element("div", { id: "arm-marks" }),
};

/** What the picture shows; it stands before anything can be done with it. */
export function armData(): Arm {
  if (arm.data === null) throw new Error("the arm is not known yet");
  return arm.data;
}
