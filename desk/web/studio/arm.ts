/**
 * The picture of the arm and what stands beside it: the last answer of the server, the drawing (null: none yet,
 * or none in this browser), the number of the instant that is shown.
 */
const arm = { data: null, view: null, instant: 0, asked: 0, playing: null, parts: {} };

/** Bands of what colours a joint; the words are in the legend, the number stands at the joint. */
const kBands = { limits: [5, 10, 25, 50], words: ["below 5 %", "5 to 10 %", "10 to 25 %", "25 to 50 %", "50 % and more"] };
const kBoundBands = {
  limits: [0.25, 0.5, 0.75, 1],
  words: ["below 0.25", "0.25 to 0.5", "0.5 to 0.75", "0.75 to 1", "beyond the bound"],
};
/* Brewer's YlOrBr: lightness alone tells the bands apart. */
const kBandColours = {
  light: ["#fff3c4", "#fed172", "#f28c28", "#b9500b", "#662506"],
  dark: ["#5b3a1e", "#94540f", "#d0751c", "#f7b04c", "#fff0b8"],
};
const kNoColour = { light: "#c3cbd3", dark: "#5d6975" };

const kColourings = {
  shown: {
    title: "Error over the time shown",
    words: "Joint, and its rms error over the time shown as a share of the rms of its torque.",
    bands: kBands,
    value: (data, joint) => data.joints[joint].error_percent,
    text: (value) => percentShort(value),
  },
  cursor: {
    title: "Error at the cursor",
    words: "Joint, and the size of its error at the cursor as a share of the rms of its torque.",
    bands: kBands,
    value: (data, joint, instant) => data.percent[joint][instant],
    text: (value) => percentShort(value),
  },
  bound: {
    title: "|e| / bound at the cursor",
    words: "Joint, and the size of its error at the cursor as a share of the bound in the robot file.",
    bands: kBoundBands,
    value: (data, joint, instant) => data.over_bound[joint][instant],
    text: (value) => formatNumber(value, ".2f"),
  },
};

function percentShort(value) {
  return value === null ? "–" : `${formatNumber(value, value < 10 ? ".1f" : ".0f")}\u202f%`;
}

function isDarkLook() {
  return currentLook() === kDarkLook;
}

function bandOf(value, { limits }) {
  return limits.filter((limit) => value >= limit).length;
}

function colouring() {
  const name = arm.parts.colours.value;
  return kColourings[name === "bound" && arm.data.over_bound === null ? "shown" : name];
}

/** Number of the instant nearest to a time. */
function instantAt(times, time) {
  const after = times.findIndex((each) => each >= time);
  if (after === -1) return times.length - 1;
  return after > 0 && time - times[after - 1] < times[after] - time ? after - 1 : after;
}

function armHost() {
  const host = element("div", {
    id: "arm-view",
    class: "arm-view",
    role: "application",
    tabindex: "0",
    "aria-roledescription": "3-D view",
    "aria-label": "The arm",
    "aria-describedby": "arm-words arm-keys",
  });
  arm.parts.labels = element("div", { class: "arm-labels", "aria-hidden": "true" });
  host.append(arm.parts.labels);
  host.addEventListener("keydown", (event) => {
    if (obeyInArm(event)) event.preventDefault();
  });
  host.addEventListener("keydown", markByKey);
  chooseByClick(host);
  leaveWheelToPage(host);
  return host;
}

/** Whether the key meant anything to the picture. */
function obeyInArm({ key, shiftKey, ctrlKey, altKey, metaKey }) {
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

function stepCursor(instants) {
  const { t_s } = arm.data;
  stopPlay();
  setCursor("at", t_s[Math.min(t_s.length - 1, Math.max(0, arm.instant + instants))]);
  const joint = look.joint - 1;
  const { name, torque_unit } = arm.data.joints[joint];
  const error = withUnit(formatSignificant(arm.data.error[joint][arm.instant], 3), torque_unit);
  say(`${timeWords(t_s[arm.instant])}; joint ${look.joint}, ${name}: error ${error}`);
}

/** A press that does not turn the view chooses the joint that is there. */
function chooseByClick(host) {
  let down = null;
  host.addEventListener("pointerdown", ({ clientX, clientY }) => (down = [clientX, clientY]), true);
  host.addEventListener("click", ({ clientX, clientY }) => {
    if (arm.view === null || down === null || Math.hypot(clientX - down[0], clientY - down[1]) > 4) return;
    const { left, top } = host.getBoundingClientRect();
    const joint = arm.view.jointAt(clientX - left, clientY - top);
    if (joint !== null && joint + 1 !== look.joint) choose({ joint: joint + 1 });
  });
}

function timeRow() {
  const slider = element("input", { type: "range", id: "arm-time", min: "0", step: "1", "aria-label": "Time" });
  slider.addEventListener("input", () => {
    stopPlay();
    setCursor("at", arm.data.t_s[Number(slider.value)]);
  });
  slider.addEventListener("keydown", markByKey);
  arm.parts.slider = slider;
  arm.parts.time = element("output", { for: "arm-time", class: "arm-time" }, "–");
  arm.parts.play = button("arm-play", "Play", togglePlay, { "data-free": "" });
  return element("div", { class: "arm-row" }, arm.parts.play, slider, arm.parts.time);
}

function labelled(label, control) {
  return element("div", { class: "choice-row" }, element("label", { for: control.id }, label), control);
}

function lookRow() {
  const colours = element("select", { id: "arm-colours" });
  for (const [name, { title }] of Object.entries(kColourings)) {
    colours.append(element("option", { value: name }, title));
  }
  colours.addEventListener("change", showInstant);
  const centres = element("input", { type: "checkbox", id: "arm-centres" });
  centres.addEventListener("change", () => arm.view?.showCentres(centres.checked));
  Object.assign(arm.parts, { colours, centres });
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
  const quantity = element("select", { id: "arm-quantity" });
  for (const [name, { name: words }] of Object.entries(kQuantities)) {
    quantity.append(element("option", { value: name }, words));
  }
  quantity.value = "error";
  quantity.addEventListener("change", showMarks);
  const set = (name) =>
    button(`set-${name}`, `Set ${name.toUpperCase()} at the cursor`, () => setCursor(name, cursor.at), { "data-free": "" });
  const clear = () => ["a", "b"].forEach((name) => setCursor(name, null));
  arm.parts.quantity = quantity;
  arm.parts.marks = element("div", { id: "arm-marks" });
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
    arm.parts.marks,
    element("p", { class: "remark" }, "A click in a chart over time sets A there, one with shift B; so do the keys a and b."),
  );
}

/** The card; drawn once the charts stand. */
function armElement() {
  const { parts } = arm;
  parts.host = armHost();
  parts.title = element("h3", { id: "arm-title" }, "The arm");
  parts.legend = element("ul", { class: "bands", "aria-labelledby": "arm-legend-words" });
  parts.words = element("p", { class: "remark", id: "arm-legend-words" });
  parts.table = element("div", { id: "arm-table" });
  const picture = element(
    "div",
    { class: "arm-picture" },
    parts.host,
    element("p", { id: "arm-words", hidden: "" }, "The same in numbers is in the table after it."),
    element(
      "p",
      { class: "keys", id: "arm-keys" },
      "Left and right move in time, shift and an arrow turns the view, + and - bring it nearer, 0 shows the whole " +
        "arm, space plays, a and b set A and B.",
    ),
    timeRow(),
  );
  const grid = element("div", { class: "arm-grid" }, picture, parts.table);
  const attributes = { class: "card arm", "aria-labelledby": "arm-title" };
  return element("section", attributes, parts.title, grid, lookRow(), parts.legend, parts.words, marksElement());
}

/** Asks for the arm of the recording and the time that are looked at. */
async function drawArm(range) {
  const asked = ++arm.asked;
  const part = range === null ? "" : `&from=${range.from}&to=${range.to}`;
  const { recording } = look;
  const data = await ask("GET", `arm?recording=${recording}${part}`);
  await Promise.all(["a", "b"].map((name) => askMark(name, recording)));
  if (asked !== arm.asked) return;
  const first = arm.data === null;
  arm.data = data;
  arm.parts.slider.max = String(data.t_s.length - 1);
  const bound = arm.parts.colours.querySelector("[value=bound]");
  bound.disabled = data.over_bound === null;
  if (cursor.at === null) setCursor("at", data.t_s[0]);
  if (first) await loadArmView();
  else showInstant();
}

async function loadArmView() {
  const { host } = arm.parts;
  let why = "This browser draws no WebGL, which the 3-D view of the arm needs: the table shows the same in numbers.";
  try {
    const { ArmView } = await import("./arm_view.js");
    arm.view = ArmView.in(host, placeLabels);
  } catch (error) {
    why = `The 3-D view of the arm cannot be drawn (${error.message}): the table shows the same in numbers.`;
  }
  if (arm.view === null) {
    const words = element("p", { class: "arm-none" }, why);
    host.replaceWith(words);
    arm.parts.centres.closest(".arm-row").hidden = true;
  } else {
    buildArm();
    darkPreference.addEventListener("change", buildArm);
  }
  showInstant();
}

function buildArm() {
  arm.view.build(arm.data, isDarkLook());
  arm.view.showCentres(arm.parts.centres.checked);
  arm.parts.labels.replaceChildren(
    ...arm.data.joints.map(() => element("span", {})),
    element("span", { class: "plain" }, "gravity"),
  );
  showInstant();
}

/** Picture, slider and tables of the instant at the cursor. */
function showInstant() {
  const { data, view, parts } = arm;
  if (data === null) return;
  arm.instant = instantAt(data.t_s, cursor.at ?? data.t_s[0]);
  const time = timeWords(data.t_s[arm.instant]);
  parts.title.textContent = `The arm at ${time}`;
  parts.host.setAttribute("aria-label", `The arm at ${time}`);
  parts.slider.value = String(arm.instant);
  parts.slider.setAttribute("aria-valuetext", time);
  parts.time.textContent = time;
  fillTable(parts.table, cursorTable(data, arm.instant));
  showMarks();
  if (view === null) return;
  showColours();
  view.pose(data, arm.instant);
}

function showColours() {
  const { data, view, parts, instant } = arm;
  const { bands, words, value, text } = colouring();
  const mode = isDarkLook() ? "dark" : "light";
  const values = data.joints.map((_, joint) => value(data, joint, instant));
  view.colour(values.map((each) => (each === null ? kNoColour[mode] : kBandColours[mode][bandOf(each, bands)])));
  data.joints.forEach((joint, index) => {
    const label = parts.labels.children[index];
    label.textContent = `${joint.joint}: ${text(values[index])}`;
    label.className = joint.joint === look.joint ? "chosen" : "";
  });
  if (parts.legend.dataset.words === words && parts.legend.dataset.mode === mode) return;
  const place = data.knows_lengths ? "" : " The robot file says no length: all joints are drawn at one place.";
  parts.words.textContent = words + place;
  Object.assign(parts.legend.dataset, { words, mode });
  parts.legend.replaceChildren(
    ...bands.words.map((each, band) =>
      element("li", {}, element("i", { style: `background:${kBandColours[mode][band]}` }), each),
    ),
  );
}

/** Beside the joints, each below those that it would cover. */
function placeLabels() {
  const { joints, gravity } = arm.view.places();
  const all = [...joints, gravity];
  const taken = [];
  const { clientWidth, clientHeight } = arm.parts.host;
  [...arm.parts.labels.children].forEach((label, index) => {
    const place = all[index];
    label.hidden = !place?.inside;
    if (label.hidden) return;
    const [width, height] = [label.offsetWidth, label.offsetHeight];
    const x = Math.min(clientWidth - width - 2, Math.max(2, place.x + 14));
    let y = Math.min(clientHeight - height - 2, Math.max(2, place.y - height - 4));
    if (index === joints.length) y = Math.max(2, place.y - height / 2);
    const covers = (other) => x < other.x + other.width + 2 && other.x < x + width + 2 && Math.abs(other.y - y) < height + 1;
    for (let tries = 0; tries < 100 && taken.some(covers); ++tries) y += 4;
    taken.push({ x, y, width });
    label.style.transform = `translate(${x}px, ${y}px)`;
  });
}

function showMarks() {
  const { data, instant, parts } = arm;
  if (data !== null) fillTable(parts.marks, markTable(data, instant, parts.quantity.value));
}

async function cursorMoved(name) {
  if (name === "at") {
    if (arm.data !== null && instantAt(arm.data.t_s, cursor.at ?? 0) !== arm.instant) showInstant();
    return;
  }
  if (cursor[name] !== null) document.getElementById("arm-compare").open = true;
  await askMark(name, look.recording).catch((error) => complain(error.message));
  showMarks();
}

function togglePlay() {
  if (arm.playing !== null) stopPlay();
  else startPlay();
}

/** In the time of the recording; where motion is to be reduced in steps of half a second. */
function startPlay() {
  const { t_s } = arm.data;
  const [first, last] = [t_s[0], t_s.at(-1)];
  const from = arm.instant >= t_s.length - 1 ? first : t_s[arm.instant];
  const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  const begun = performance.now();
  holdsPointer = true;
  arm.parts.play.textContent = "Pause";
  const tick = (now) => {
    const passed = Math.max(0, now - begun) / 1000;
    const time = from + (still ? Math.floor(2 * passed) / 2 : passed);
    setCursor("at", Math.min(time, last));
    if (time >= last) stopPlay();
    else arm.playing = requestAnimationFrame(tick);
  };
  arm.playing = requestAnimationFrame(tick);
}

function stopPlay() {
  if (arm.playing === null) return;
  cancelAnimationFrame(arm.playing);
  arm.playing = null;
  holdsPointer = false;
  arm.parts.play.textContent = "Play";
}

cursorWatchers.push(cursorMoved);
