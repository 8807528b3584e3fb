/**
 * A number of a step under the reader's hand: charts and errors follow, the model stays at its fit and the number
 * snaps back once it is let go.
 */
const dragging = { waiting: null, last: null, isAsking: false, isOff: false };

/** Every fitted number of a step as a slider. */
function dragElement(step, actions) {
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

function dragRow(step, name, range, actions) {
  const id = `drag-${step.id}-${name}`;
  const slider = element("input", { type: "range", id, min: range.low, max: range.high, step: "any" });
  slider.value = String(range.value);
  const { unit } = step.parameters[name];
  const told = element("output", { for: id });
  const words = () => (told.textContent = withUnit(formatSignificant(Number(slider.value), 4), unit));
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
  // Arrow keys go in steps of a hundredth of the way.
  slider.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
    if (way === undefined) return;
    event.preventDefault();
    slider.value = String(Number(slider.value) + (way * (range.high - range.low)) / 100);
    slider.dispatchEvent(new Event("input"));
  });
  return element("div", { class: "drag-row" }, element("label", { for: id }, `${name.replaceAll("_", " ")}, with all steps`), slider, told);
}

/** Nothing is dragged any more: its slider is gone, or the model is another one. */
function letGo() {
  dragging.waiting = dragging.last = null;
  dragging.isOff = false;
}

/** One question at a time: the last number that was dragged to is asked for next. */
async function followDrag(number, draw) {
  dragging.waiting = dragging.last = number;
  dragging.isOff = true;
  if (dragging.isAsking) return;
  dragging.isAsking = true;
  try {
    while (dragging.waiting !== null) {
      const { step, parameter, value } = dragging.waiting;
      dragging.waiting = null;
      await draw(`step=${step}&parameter=${parameter}&value=${value}`);
    }
  } catch (error) {
    letGo();
    throw error;
  } finally {
    dragging.isAsking = false;
  }
}
