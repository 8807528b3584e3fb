import { element } from "../report/element";
import type { Pair } from "../report/figure_type";
import { formatNumber, withUnit } from "../report/format";
import { kArrows, say } from "../report/keys";
import { itemAt } from "../report/lists";
import { leaveWheelToPage } from "../report/zoom";
import { cursorMoved, showInstant, showMarks } from "./arm";
import { kColourings } from "./arm_colours";
import { stopPlay, togglePlay } from "./arm_play";
import { arm, armData, armParts } from "./arm_state";
import { kQuantities } from "./arm_tables";
import { choose } from "./changes";
import { cursor, markByKey, setCursor, timeWords, watchCursors } from "./cursor";
import { button } from "./parts";
import { look } from "./session";

function armHost() {
  const { host, labels } = armParts;
  host.append(labels);
  host.addEventListener("keydown", (event) => {
    if (obeyInArm(event)) event.preventDefault();
  });
  host.addEventListener("keydown", markByKey);
  chooseByClick(host);
  leaveWheelToPage(host);
  return host;
}

/** Whether the key meant anything to the picture. */
function obeyInArm({ key, shiftKey, ctrlKey, altKey, metaKey }: KeyboardEvent): boolean {
  const { data, view } = arm;
  if (ctrlKey || altKey || metaKey || data === null) return false;
  const arrow = kArrows[key];
  if (arrow && shiftKey) view?.turn(...arrow);
  else if (arrow && arrow[0] !== 0) stepCursor(arrow[0] * Math.max(1, Math.round(data.t_s.length / 100)));
  else if (key === "+" || key === "=") view?.nearer(1.2);
  else if (key === "-") view?.nearer(1 / 1.2);
  else if (key === "0") view?.showAll();
  else if (key === " ") togglePlay();
  else return false;
  return true;
}

function stepCursor(instants: number) {
  const { t_s, joints, error: errors } = armData();
  stopPlay();
  setCursor("at", itemAt(t_s, Math.min(t_s.length - 1, Math.max(0, arm.instant + instants))));
  const joint = look.joint - 1;
  const { name, torque_unit } = itemAt(joints, joint);
  const error = withUnit(formatNumber(errors[joint]?.[arm.instant] ?? null, ".3g"), torque_unit);
  say(`${timeWords(itemAt(t_s, arm.instant))}; joint ${look.joint}, ${name}: error ${error}`);
}

/** A press that does not turn the view chooses the joint that is there. */
function chooseByClick(host: HTMLElement) {
  let down: Pair | null = null;
  host.addEventListener("pointerdown", ({ clientX, clientY }) => (down = [clientX, clientY]), true);
  host.addEventListener("click", ({ clientX, clientY }) => {
    if (arm.view === null || down === null || Math.hypot(clientX - down[0], clientY - down[1]) > 4) return;
    const { left, top } = host.getBoundingClientRect();
    const joint = arm.view.jointAt(clientX - left, clientY - top);
    if (joint !== null && joint + 1 !== look.joint) void choose({ joint: joint + 1 });
  });
}

function timeRow() {
  const { slider, time } = armParts;
  slider.addEventListener("input", () => {
    stopPlay();
    setCursor("at", itemAt(armData().t_s, Number(slider.value)));
  });
  slider.addEventListener("keydown", markByKey);
  const play = button("arm-play", "Play", togglePlay, { "data-free": "" });
  return element("div", { class: "arm-row" }, play, slider, time);
}

function labelled(label: string, control: HTMLElement) {
  return element("div", { class: "choice-row" }, element("label", { for: control.id }, label), control);
}

function lookRow() {
  const { colours, centres } = armParts;
  for (const [name, { title }] of Object.entries(kColourings)) {
    colours.append(element("option", { value: name }, title));
  }
  colours.addEventListener("change", showInstant);
  centres.addEventListener("change", () => arm.view?.showCentres(centres.checked));
  const whole = button("arm-whole", "Whole arm", () => arm.view?.showAll(), { "data-free": "" });
  return element(
    "div",
    { class: "arm-row" },
    labelled("Colour", colours),
    element("div", { class: "choice-row" }, centres, element("label", { for: "arm-centres" }, "Centres of mass")),
    whole,
  );
}

function marksElement() {
  const { quantity, marks } = armParts;
  for (const [name, { name: words }] of Object.entries(kQuantities)) {
    quantity.append(element("option", { value: name }, words));
  }
  quantity.value = "error";
  quantity.addEventListener("change", showMarks);
  const set = (name: "a" | "b") =>
    button(`set-${name}`, `Set ${name.toUpperCase()} at the cursor`, () => setCursor(name, cursor.at), { "data-free": "" });
  const clear = () => {
    setCursor("a", null);
    setCursor("b", null);
  };
  const row = element(
    "div",
    { class: "arm-row" },
    set("a"),
    set("b"),
    button("clear-marks", "Clear", clear, { "data-free": "" }),
    labelled("Show", quantity),
  );
  return element(
    "details",
    { id: "arm-compare" },
    element("summary", {}, "Two instants, A and B, and what differs"),
    row,
    marks,
    element("p", { class: "remark" }, "A click in a chart over time sets A there, one with shift B; so do the keys a and b."),
  );
}

/** The card; drawn once the charts stand. */
export function armElement() {
  const { title, legend, words, table } = armParts;
  watchCursors(cursorMoved);
  const picture = element(
    "div",
    { class: "arm-picture" },
    armHost(),
    element("p", { id: "arm-words", hidden: "" }, "The same in numbers is in the table after it."),
    element(
      "p",
      { class: "keys", id: "arm-keys" },
      "Left and right move in time, shift and an arrow turns the view, + and - bring it nearer, 0 shows the whole " +
        "arm, space plays, a and b set A and B.",
    ),
    timeRow(),
  );
  const grid = element("div", { class: "arm-grid" }, picture, table);
  const attributes = { class: "card arm", "aria-labelledby": "arm-title" };
  return element("section", attributes, title, grid, lookRow(), legend, words, marksElement());
}
