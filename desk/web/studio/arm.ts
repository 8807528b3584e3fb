import { element, within } from "../report/element";
import { itemAt } from "../report/lists";
import { darkPreference, isDarkLook } from "../report/look";
import type { Arm } from "./api";
import { bandColour, colouringOf, colourOf, instantAt } from "./arm_colours";
import { askMark, fillTable, marks } from "./arm_numbers";
import { arm, armData, armParts } from "./arm_state";
import { cursorTable, markTable, type Quantity } from "./arm_tables";
import { ArmView } from "./arm_view";
import { cursor, setCursor, timeWords, type CursorName } from "./cursor";
import { complainOf } from "./message";
import { ask, wordsOf } from "./server";
import { look } from "./session";
import type { TimeRange } from "./time_range";

/** Asks for the arm of the recording and the time that are looked at. */
export async function drawArm(range: TimeRange | null) {
  const asked = ++arm.asked;
  const { recording } = look;
  const data = await ask("GET", "/arm", { query: { recording, ...range } });
  await Promise.all([askMark("a", recording), askMark("b", recording)]);
  if (asked !== arm.asked) return;
  const first = arm.data === null;
  arm.data = data;
  armParts.slider.max = String(data.t_s.length - 1);
  const bound = within<HTMLOptionElement>(armParts.colours, "[value=bound]");
  bound.disabled = data.over_bound === null;
  if (cursor.at === null) setCursor("at", itemAt(data.t_s, 0));
  if (first) await loadArmView();
  else showInstant();
}

async function loadArmView() {
  const { host, centres } = armParts;
  let why = "This browser draws no WebGL, which the 3-D view of the arm needs: the table shows the same in numbers.";
  try {
    const { ArmView } = await import("./arm_view.js");
    arm.view = ArmView.in(host, placeLabels);
  } catch (error) {
    why = `The 3-D view of the arm cannot be drawn (${wordsOf(error)}): the table shows the same in numbers.`;
  }
  if (arm.view === null) {
    const words = element("p", { class: "arm-none" }, why);
    host.replaceWith(words);
    centres.closest<HTMLElement>(".arm-row")?.toggleAttribute("hidden", true);
  } else {
    buildArm();
    darkPreference.addEventListener("change", buildArm);
  }
  showInstant();
}

function buildArm() {
  const { view } = arm;
  if (view === null) return;
  view.build(armData(), isDarkLook());
  view.showCentres(armParts.centres.checked);
  armParts.labels.replaceChildren(
    ...armData().joints.map(() => element("span", {})),
    element("span", { class: "plain" }, "gravity"),
  );
  showInstant();
}

/** Picture, slider and tables of the instant at the cursor. */
export function showInstant() {
  const { data, view } = arm;
  const parts = armParts;
  if (data === null) return;
  arm.instant = instantAt(data.t_s, cursor.at ?? itemAt(data.t_s, 0));
  const time = timeWords(itemAt(data.t_s, arm.instant));
  parts.title.textContent = `The arm at ${time}`;
  parts.host.setAttribute("aria-label", `The arm at ${time}`);
  parts.slider.value = String(arm.instant);
  parts.slider.setAttribute("aria-valuetext", time);
  parts.time.textContent = time;
  fillTable(parts.table, cursorTable(data, arm.instant));
  showMarks();
  if (view === null) return;
  showColours(data, view);
  view.pose(data, arm.instant);
}

function showColours(data: Arm, view: ArmView) {
  const { instant } = arm;
  const parts = armParts;
  const { bands, words, value, text } = colouringOf(parts.colours.value, data);
  const mode = isDarkLook() ? "dark" : "light";
  const values = data.joints.map((_, joint) => value(data, joint, instant));
  view.colour(values.map((each) => colourOf(each, bands, mode)));
  data.joints.forEach((joint, index) => {
    const label = parts.labels.children[index];
    if (label === undefined) return;
    label.textContent = `${joint.joint}: ${text(values[index] ?? null)}`;
    label.className = joint.joint === look.joint ? "chosen" : "";
  });
  if (parts.legend.dataset.words === words && parts.legend.dataset.mode === mode) return;
  const place = data.knows_lengths ? "" : " The robot file says no length: all joints are drawn at one place.";
  parts.words.textContent = words + place;
  Object.assign(parts.legend.dataset, { words, mode });
  parts.legend.replaceChildren(
    ...bands.words.map((each, band) =>
      element("li", {}, element("i", { style: `background:${bandColour(band, mode)}` }), each),
    ),
  );
}

/** Beside the joints, each below those that it would cover. */
function placeLabels() {
  if (arm.view === null) return;
  const { joints, gravity } = arm.view.places();
  const all = [...joints, gravity];
  const taken: { x: number; y: number; width: number }[] = [];
  const { clientWidth, clientHeight } = armParts.host;
  armParts.labels.querySelectorAll<HTMLElement>("span").forEach((label, index) => {
    const place = all[index];
    label.hidden = !place?.inside;
    if (!place?.inside) return;
    const [width, height] = [label.offsetWidth, label.offsetHeight];
    const x = Math.min(clientWidth - width - 2, Math.max(2, place.x + 14));
    let y = Math.min(clientHeight - height - 2, Math.max(2, place.y - height - 4));
    if (index === joints.length) y = Math.max(2, place.y - height / 2);
    const covers = (other: (typeof taken)[number]) => x < other.x + other.width + 2 && other.x < x + width + 2 && Math.abs(other.y - y) < height + 1;
    for (let tries = 0; tries < 100 && taken.some(covers); ++tries) y += 4;
    taken.push({ x, y, width });
    label.style.transform = `translate(${x}px, ${y}px)`;
  });
}

export function showMarks() {
  const { data, instant } = arm;
  const { marks: host, quantity } = armParts;
  if (data !== null) fillTable(host, markTable(data, marks, instant, quantity.value as Quantity));
}

export async function cursorMoved(name: CursorName) {
  if (name === "at") {
    if (arm.data !== null && instantAt(arm.data.t_s, cursor.at ?? 0) !== arm.instant) showInstant();
    return;
  }
  if (cursor[name] !== null) within<HTMLDetailsElement>(document, "#arm-compare").open = true;
  await askMark(name, look.recording).catch(complainOf);
  showMarks();
}

