/** What is looked at, and what the server last said. */
const look = { joint: 1, recording: 1, beside: null };
let state = null;
let found = { state: "none" };
let busy = false;
/** What was chosen last while a change was under way. */
let wish = null;
/** Under "save": what came of it, or what has to be confirmed. */
let saving = { words: "", level: "neutral", confirm: null, name: null };

const places = {};

function place(name, attributes = {}) {
  places[name] = element("div", { id: `place-${name}`, ...attributes });
  return places[name];
}

function currentJoint() {
  return state.joints[look.joint - 1];
}

function errorOf(joint, when) {
  const { held_out_percent, fitted_percent } = joint[when];
  return held_out_percent ?? fitted_percent;
}

function baseName(path) {
  return path.split("/").at(-1);
}

function headerContent() {
  const names = (held) => state.recordings.filter((each) => each.held_out === held).map((each) => baseName(each.name));
  const judged = state.held_out === "recordings" ? names(true).join(", ") : "parts of the same, held out in turn";
  // Below results a run is a part of the page.
  const { setup, open } = results;
  const title = setup === null ? element("h1", {}, `Studio: ${state.robot.name}`) : element("h2", {}, `${effectTitle(setup.item)} ${open}`);
  const header = element("header", {}, title);
  header.append(
    element(
      "p",
      { class: "subtitle" },
      `${state.robot.file} · fitted to ${names(false).join(", ")} · judged on ${judged}`,
    ),
  );
  return header;
}

function jointRow(joint) {
  const id = `joint-${joint.joint}`;
  const input = element("input", { type: "radio", name: "joint", id, value: String(joint.joint) });
  input.checked = joint.joint === look.joint;
  input.addEventListener("change", () => choose({ joint: joint.joint }));
  const start = errorOf(joint, "start");
  const now = errorOf(joint, "now");
  const bar = element("span", { class: "bar", "aria-hidden": "true" });
  const width = (value) => `${Math.min(100, Math.max(0, value ?? 0))}%`;
  bar.append(element("i", { class: "was", style: `width:${width(start)}` }));
  bar.append(element("i", { class: "is", style: `width:${width(now)}` }));
  const numbers =
    start === now ? percent(now) : [`${percent(start)} → `, element("b", {}, percent(now))];
  const label = element("label", { for: id });
  label.append(
    element("span", { class: "joint-name" }, `${joint.joint}. ${joint.name}${joint.moves ? "" : " (stands still)"}`),
    bar,
    element("span", { class: "joint-numbers" }, ...[numbers].flat()),
  );
  return element("div", { class: "joint" }, input, label);
}

function jointChoice() {
  const set = element("fieldset", { class: "joints" }, element("legend", {}, "Joint, and its error"));
  for (const joint of state.joints) set.append(jointRow(joint));
  return set;
}

function figureOf(label, value, note, level) {
  return { label, value, unit: "%", format: ".2f", level, note };
}

/** Without a recording that is held out, a fit alone leaves a part of the recording for its judge. */
function notHeldOut(isDragged) {
  return isDragged ? "no recording is held out: known at the fit" : "no recording is held out: known once an effect is added";
}

/** `dragged`: the errors of a model that is off its fit. */
function headlineContent(dragged = null) {
  const joint = currentJoint();
  const { start } = joint;
  const now = dragged ?? joint.now;
  const fell = (key) => {
    if (state.steps.length === 0 || start[key] === null || now[key] === null) return "as read";
    return `as read ${formatNumber(start[key], ".2f")} %`;
  };
  const better = (key) => now[key] !== null && start[key] !== null && now[key] < 0.98 * start[key];
  const figuresOf = [
    figureOf(
      `Joint ${joint.joint}: error on held-out data${dragged === null ? "" : ", dragged"}`,
      now.held_out_percent,
      now.held_out_percent === null ? notHeldOut(dragged !== null) : fell("held_out_percent"),
      better("held_out_percent") ? "good" : "neutral",
    ),
    figureOf(
      `Joint ${joint.joint}: error on fitted data${dragged === null ? "" : ", dragged"}`,
      now.fitted_percent,
      fell("fitted_percent"),
      "neutral",
    ),
  ];
  return keyFiguresElement({ figures: figuresOf }, "headline");
}

function meaningContent() {
  return explained(
    "What do these numbers mean?",
    "The error is what the model misses of the measured torque: the root mean square of measured " +
      "minus model, as a share of that of the measured torque, both low-passed alike. 0 % is a " +
      "perfect model.",
    "Held-out data were not used for the fit: only an error that falls there shows that an effect " +
      "is real. On fitted data it falls with every number that is fitted.",
  );
}

function recordingPicker() {
  const select = element("select", { id: "recording-choice" });
  state.recordings.forEach((each, index) => {
    const option = element(
      "option",
      { value: String(index + 1) },
      `${baseName(each.name)} (${each.held_out ? "held out" : "fitted"})`,
    );
    option.selected = index + 1 === look.recording;
    select.append(option);
  });
  select.addEventListener("change", () => choose({ recording: Number(select.value) }));
  const row = element("div", { class: "choice-row" }, element("label", { for: "recording-choice" }, "Recording"), select);
  if (state.recordings.length < 2) return row;
  const others = state.recordings.map((each, index) => [String(index + 1), baseName(each.name)]);
  const options = [["", "none"], ...others.filter(([number]) => Number(number) !== look.recording)];
  const chosen = look.beside === null ? "" : String(look.beside);
  row.append(
    choiceOf("beside-choice", "and over it", options, chosen, (value) =>
      choose({ beside: value === "" ? null : Number(value) }),
    ),
  );
  return row;
}

function saveContent() {
  const { save } = state;
  if (state.steps.length === 0) {
    return [
      element("p", { class: "empty" }, "There is nothing to save yet: switch an effect on first."),
    ];
  }
  const name = element("input", { type: "text", id: "save-name", spellcheck: "false", autocomplete: "off" });
  name.value = saving.name ?? save.name;
  name.readOnly = save.fixed;
  name.addEventListener("input", () => {
    saving = { ...saving, name: name.value, confirm: null, words: "" };
    places.save.querySelector(".note")?.remove();
  });
  const form = element("div", { class: "save-row" });
  form.append(
    element("label", { for: "save-name" }, save.fixed ? "Robot file" : "Robot file, beside the one that was read"),
    name,
    button("save-file", "Save", () => actions.save({}), { class: "action main" }),
    button("save-page", "Save a page for others", actions.savePage),
  );
  const content = [form];
  if (saving.words !== "") {
    const note = noteWith(saving.level, saving.words, " ");
    if (saving.confirm !== null) {
      const { confirm } = saving;
      const again = typeof confirm === "function" ? confirm : () => actions.save(confirm);
      note.firstChild.append(button("save-anyway", "Save all the same", again));
    }
    content.push(note);
  }
  return [...content, ...commandsContent(save)];
}

function commandsContent({ commands, commands_note: note }) {
  if (commands.length === 0) {
    const why = "The robot file that was read is replaced: no command can start from it any more.";
    return [element("p", { class: "remark" }, why)];
  }
  const copy = () => navigator.clipboard.writeText(commands.join("\n"));
  return [
    element(
      "p",
      { class: "remark" },
      "The same without Studio, numbers and file alike; each writes a file that is not there yet:",
    ),
    ...(note === "" ? [] : [element("p", { class: "remark" }, note)]),
    element("pre", { tabindex: "0", "aria-label": "Commands that repeat this session" }, commands.join("\n")),
    button("copy", "Copy the commands", copy, { "data-free": "" }),
  ];
}

function show() {
  const joint = currentJoint();
  if (results.setup === null) document.title = `Studio: ${state.robot.name}`;
  const host = results.setup === null ? places.head : places.run;
  replaceContent(host, headerContent(), ...state.hints.map((hint) => noteWith("warn", hint)));
  replaceContent(places.joints, jointChoice());
  replaceContent(places.headline, headlineContent());
  document.getElementById("effects-heading").textContent = `Effects of joint ${joint.joint}`;
  replaceContent(places.effects, ...effectList(joint, actions));
  replaceContent(places.recording, recordingPicker());
  showExploreChoices(state.joints, () => explore(zoomRange()));
  replaceContent(places.steps, ...keptContent(), stepList(state, actions));
  places.fall.hidden = state.steps.length === 0;
  showFound();
  showSave();
}

function showSave() {
  replaceContent(places.save, ...saveContent());
  if (busy) holdControls(true);
}

function showFound() {
  if (found.state !== "running" || !updateProgress(found)) {
    replaceContent(places.learn, ...learnContent(found, state, actions));
    if (busy) holdControls(true);
  }
  document.body.toggleAttribute("data-searching", found.state === "running");
  forgetUnseen();
}

function setBusy(value) {
  busy = value;
  document.body.toggleAttribute("data-busy", value);
  places.effects.setAttribute("aria-busy", String(value));
  holdControls(value);
}

function complain(words) {
  replaceContent(places.message, words === "" ? "" : noteWith("bad", words));
  if (words !== "") places.message.scrollIntoView({ block: "nearest" });
}

/** Of several questions about the charts the answer to the last one is shown. */
let chartsAsked = 0;

async function askForCharts(address) {
  const own = ++chartsAsked;
  const answer = await ask("GET", address);
  if (own !== chartsAsked) return null;
  document.body.dataset.revision = String(answer.revision);
  return answer;
}

async function drawCharts() {
  const range = zoomRange();
  const answer = await askForCharts(chartAddress(look, range));
  if (answer === null) return;
  showCharts(answer, places.charts, places.fall);
  showArm(range);
  explore(range);
}

/** What a zoom changes; null: all of the time is shown. */
async function drawFiner(range) {
  showArm(range);
  explore(range);
  if (dragging.isOff) return actions.drag(dragging.last);
  const answer = await askForCharts(chartAddress(look, range));
  if (answer !== null) showFiner(answer);
}

/** Nothing waits for map and spectrum either. */
function explore(range) {
  drawExplored(look, range).catch((error) => complain(error.message));
}

/** Nothing waits for the arm. */
function showArm(range) {
  drawArm(range).catch((error) => complain(error.message));
}

/** Runs one change at a time; what fails is said, and nothing else has changed. */
async function change(work) {
  if (busy) return;
  setBusy(true);
  complain("");
  try {
    await work();
  } catch (error) {
    complain(error.message);
  }
  setBusy(false);
  if (wish === null) return;
  const chosen = wish;
  wish = null;
  await choose(chosen);
}

async function changeModel(method, path, body) {
  await change(async () => {
    state = await ask(method, path, body);
    letGo();
    saving = { ...saving, words: "", confirm: null };
    show();
    await drawCharts();
    const joint = currentJoint();
    say(`Joint ${joint.joint}: error now ${percent(errorOf(joint, "now"))}`);
  });
}

/** The next page over this session begins where this one is; nothing waits for it. */
function keepLook() {
  const range = zoomRange();
  ask("POST", "look", { ...look, from: range?.from ?? null, to: range?.to ?? null }).catch((error) =>
    complain(error.message),
  );
}

/** Another joint or recording; while a change is under way the last wish waits for its end. */
async function choose(what) {
  if (busy) {
    wish = { ...wish, ...what };
    return;
  }
  await change(async () => {
    if (what.recording) {
      if (what.recording === look.beside) look.beside = null;
      showWhole();
      stopPlay();
      clearCursors();
    }
    Object.assign(look, what);
    show();
    await drawCharts();
    keepLook();
  });
}

async function follow() {
  while (found.state === "running") {
    await new Promise((done) => setTimeout(done, 400));
    try {
      found = await ask("GET", "explanation");
    } catch (error) {
      complain(error.message);
      return;
    }
    showFound();
  }
  say(found.state === "done" ? found.answer.words : "The search has ended.");
}

const actions = {
  add: (effect, joint) => {
    if (!busy) look.joint = joint;
    return changeModel("POST", "steps", { effect, joint }).then(keepLook);
  },
  drag: (number) => followDrag(number, drawDragged).catch((error) => complain(error.message)),
  snapBack: () => {
    if (!dragging.isOff) return;
    letGo();
    replaceContent(places.headline, headlineContent());
    drawCharts().catch((error) => complain(error.message));
  },
  undoAll: () => changeModel("DELETE", "steps"),
  savePage: () => change(savePage),
  undo: (id) => changeModel("DELETE", `steps/${id}`),
  toggle: (effect, joint) =>
    effect.steps.length > 0 ? actions.undo(effect.steps.at(-1)) : actions.add(effect.effect, joint),
  search: () =>
    change(async () => {
      found = await ask("POST", "explanation");
      showFound();
      follow();
    }),
  stop: async () => {
    await ask("DELETE", "explanation").catch((error) => complain(error.message));
  },
  save: (agreed) => change(() => save(agreed)),
};

async function save(agreed) {
  const name = saving.name ?? state.save.name;
  try {
    const { saved, commands } = await ask("POST", "save", { ...(state.save.fixed ? {} : { name }), ...agreed });
    state.save = { ...state.save, saved, commands, name: state.save.fixed ? state.save.name : name };
    saving = { ...saving, words: `Written: ${saved}`, level: "good", confirm: null };
  } catch (error) {
    const confirm = error.confirm ? nextConfirm(agreed) : null;
    saving = { ...saving, words: error.message, level: error.confirm ? "warn" : "bad", confirm };
  }
  showSave();
  say(saving.words);
}

/** The report page of `compare`, for those who have no Studio. */
async function savePage(agreed = {}) {
  const name = saving.name ?? state.save.name;
  try {
    const { saved } = await ask("POST", "page", { ...(state.save.fixed ? {} : { name }), ...agreed });
    saving = { ...saving, words: `Written: ${saved}`, level: "good", confirm: null };
  } catch (error) {
    const again = error.confirm ? () => change(() => savePage({ replace: true })) : null;
    saving = { ...saving, words: error.message, level: error.confirm ? "warn" : "bad", confirm: again };
  }
  showSave();
  say(saving.words);
}

/** Charts and errors with a number off its fit: no model, and nothing of it stays. */
async function drawDragged(words) {
  const parts = chartAddress(look, zoomRange()).replace(/^charts\?/, "");
  const answer = await askForCharts(`moved?${words}&${parts}`);
  if (answer === null || !dragging.isOff || answer.revision !== state.revision) return;
  const { fitted_percent, held_out_percent } = answer;
  replaceContent(places.headline, headlineContent({ fitted_percent, held_out_percent }));
  showFiner(answer);
}

/** Where the session is kept, and what was taken up of one before. */
function keptContent() {
  const { file, problem, taken_up: count, not_taken_up: why } = state.kept;
  const content = [];
  if (count > 0 && state.steps.length > 0) {
    const what = count === 1 ? "One step was" : `${count} steps were`;
    const note = noteWith("neutral", `${what} added in a session before, and taken up from ${baseName(file)}. `);
    note.firstChild.append(button("begin-anew", "Begin anew", actions.undoAll));
    content.push(note);
  }
  if (why !== "") content.push(noteWith("warn", `Not all of the session before could be taken up: ${why}`));
  if (problem !== "") content.push(noteWith("warn", `What is done here is not kept: ${problem}`));
  return content;
}

/** What a second "save" agrees to: first that a step is in doubt, then that a file is there. */
function nextConfirm(agreed) {
  const doubtful = state.steps.some((step) => step.doubts.length > 0);
  return doubtful && !agreed.accept_doubts ? { accept_doubts: true } : { ...agreed, replace: true };
}

function buildStudio() {
  const main = element("main");
  const side = element("div", { class: "side" });
  side.append(place("joints"), sectionWith("effects", "Effects", place("effects")));
  const pictures = element("div", { class: "pictures" });
  pictures.append(
    place("headline"),
    place("message", { role: "alert" }),
    sectionWith(
      "look",
      "Measured and model",
      meaningContent(),
      place("recording"),
      armElement(),
      place("charts", { class: "blocks" }),
      exploreElement(),
    ),
    sectionWith("steps", "What was added", place("fall"), place("steps")),
    sectionWith("learn", "What is missing?", place("learn")),
    sectionWith("save", "Save", place("save")),
  );
  const desk = place("desk", { class: "desk" });
  desk.append(place("run", { class: "run" }), side, pictures);
  main.append(place("head"), place("live"), place("load"), place("results"), desk);
  const footer = element("footer");
  footer.append(
    element("p", { id: "spoken", class: "hidden-text", role: "status" }),
    element("p", {}, "offnominal Studio, diagnostic aid, claims no SIL/PL. Nothing leaves this machine."),
    element(
      "p",
      { class: "chart-help" },
      "Charts: drag to zoom, shift-drag to move, ctrl-wheel to zoom, double click to reset. A chart that " +
        "has the focus takes keys: arrows show values, + and - zoom, 0 resets. The arm: drag to turn, ctrl-wheel to come nearer. " +
        "Drawn with Apache ECharts and three.js.",
    ),
  );
  document.getElementById("page").append(main, footer);
}

/** What the session holds now: at the start, and when a live view hands a stretch over to it. */
async function loadSession() {
  state = await ask("GET", "state");
  found = await ask("GET", "explanation");
  places.desk.hidden = false;
  letGo();
  forgetExploredJoints();
  const worst = state.joints.reduce((a, b) => (errorOf(b, "now") > errorOf(a, "now") && b.moves ? b : a));
  Object.assign(look, { joint: worst.joint, recording: 1, beside: null });
  const kept = state.look;
  if (kept !== null) Object.assign(look, { joint: kept.joint, recording: kept.recording, beside: kept.beside });
  saving = { words: "", level: "neutral", confirm: null, name: null };
  show();
  await drawCharts();
  if (kept !== null && kept.from !== null && kept.to !== null) showTime(kept);
  if (found.state === "running") follow();
}

/** Before a live view has handed anything over there is nothing to analyse. */
function showUnloaded({ robot }) {
  document.title = `Studio: ${robot.name}`;
  places.desk.hidden = true;
  const header = element("header", {}, element("h1", {}, `Studio: ${robot.name}`));
  header.append(element("p", { class: "subtitle" }, `${robot.file} · no recording is loaded: a detection that is explained is`));
  replaceContent(places.head, header);
}

async function start() {
  buildStudio();
  onZoom = (range) => {
    keepLook();
    drawFiner(range).catch((error) => complain(error.message));
  };
  try {
    const setup = await ask("GET", "live");
    places.desk.hidden = !setup.loaded;
    if (setup.takes_files) {
      await startLoad(places.load, setup.loaded, async () => {
        await loadSession();
        places.head.scrollIntoView({ block: "start" });
      });
    } else if (setup.has_results) {
      await startResults(places.results, async () => {
        await loadSession();
        places.desk.scrollIntoView({ block: "start" });
      });
    } else if (!setup.loaded) showUnloaded(setup);
    if (setup.source !== null) {
      startLive(setup, places.live, async () => {
        await loadSession();
        document.getElementById("learn").scrollIntoView({ block: "start" });
      });
    }
    if (setup.loaded) await loadSession();
  } catch (error) {
    places.desk.hidden = false;
    complain(error.message);
  }
}

start();
