import { element } from "../report/element";
import { formatSignificant, withUnit } from "../report/format";
import type { Actions } from "./actions";
import type { Draggable, Step } from "./api";
import { foldWith } from "./parts";

/**
 * A number of a step under the reader's hand: charts and errors follow, the model stays at its fit and the number
 * snaps back once it is let go.
 */
export const dragging: { waiting: Dragged | null; last: Dragged | null; isAsking: boolean; isOff: boolean } = {
  waiting: null,
  last: null,
  isAsking: false,
  isOff: false,
};

/** A parameter of a step, and what it is dragged to. */
export interface Dragged {
  step: number;
  parameter: string;
  value: number;
}

const kWays: Record<string, number> = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 };

/** Where an arrow key takes the number: a hundredth of the way, and no further than it goes; null: no arrow. */
export function steppedBy(key: string, value: number, { low, high }: Draggable): number | null {
  const way = kWays[key];
  return way === undefined ? null : Math.min(high, Math.max(low, value + (way * (high - low)) / 100));
}

/** Every fitted number of a step as a slider. */
export function dragElement(step: Step, actions: Actions) {
  const id = `drag-${step.id}`;
  const details = foldWith(id, "Drag its numbers");
  details.append(
    element("p", { class: "remark" }, "The charts follow a number that is off its fit; let go, and it snaps back."),
  );
  for (const [name, range] of Object.entries(step.draggable)) {
    details.append(dragRow(step, name, range, actions));
  }
  return details;
}

function dragRow(step: Step, name: string, range: Draggable, actions: Actions) {
  const id = `drag-${step.id}-${name}`;
  const slider = element("input", { type: "range", id, min: String(range.low), max: String(range.high), step: "any" });
  slider.value = String(range.value);
  const unit = step.parameters[name]?.unit ?? "";
  const told = element("output", { for: id });
  const words = () => {
    const value = withUnit(formatSignificant(Number(slider.value), 4), unit);
    told.textContent = value;
    slider.setAttribute("aria-valuetext", value);
  };
  words();
  const back = () => {
    if (Number(slider.value) === range.value) return;
    slider.value = String(range.value);
    words();
    actions.snapBack();
  };
  slider.addEventListener("input", () => {
    words();
    actions.drag({ step: step.id, parameter: name, value: Number(slider.value) });
  });
  slider.addEventListener("pointerup", back);
  slider.addEventListener("pointercancel", back);
  slider.addEventListener("blur", back);
  slider.addEventListener("keydown", ({ key }) => key === "Escape" && back());
  slider.addEventListener("keydown", (event) => {
    const next = steppedBy(event.key, Number(slider.value), range);
    if (next === null) return;
    event.preventDefault();
    slider.value = String(next);
    slider.dispatchEvent(new Event("input"));
  });
  return element("div", { class: "drag-row" }, element("label", { for: id }, `${name.replaceAll("_", " ")}, with all steps`), slider, told);
}

/** Nothing is dragged any more: its slider is gone, or the model is another one. */
export function letGo() {
  dragging.waiting = dragging.last = null;
  dragging.isOff = false;
}

/** One question at a time: the last number that was dragged to is asked for next. */
export async function followDrag(number: Dragged, draw: (number: Dragged) => Promise<void>) {
  dragging.waiting = dragging.last = number;
  dragging.isOff = true;
  if (dragging.isAsking) return;
  dragging.isAsking = true;
  try {
    while (dragging.waiting !== null) {
      const next: Dragged = dragging.waiting;
      dragging.waiting = null;
      await draw(next);
    }
  } catch (error) {
    letGo();
    throw error;
  } finally {
    dragging.isAsking = false;
  }
}
