/** How often the page asks what is new, and draws it: ms. */
const kLivePictureMs = 1000 / 30;
/** Numbers that change faster nobody reads. */
const kLiveNumbersMs = 250;

/** What there is of a live view; `setup` as GET live says it. */
const live = {
  setup: null,
  now: null,
  next: 0,
  curves: [],
  picture: null,
  numbersAt: 0,
  pictures: [],
  shown: 0, // the number of the detection whose surroundings are drawn
  told: 0, // and of the one that was said aloud
  saved: "",
  frozen: [],
  fillTable: null,
};

function isBench() {
  return live.setup.source === "sil";
}

function jointName(joint) {
  return `joint ${joint} (${live.setup.joints[joint - 1]})`;
}

function liveHeading() {
  const { robot, source, bus, plant } = live.setup;
  if (source !== "sil") return `Live: ${robot.name} on ${bus}`;
  return `Live: simulated run of ${robot.name}${plant === null ? "" : `, its plant ${plant}`}`;
}

function controllerWords({ controller }) {
  if (controller === null) return "says nothing of itself on this bus";
  return controller.fault === null ? controller.state : `${controller.state}: ${controller.fault}`;
}

function monitorWords(now) {
  if (now.ended !== "") return now.ended;
  if (now.words !== "") return now.words;
  if (!now.driven) return "The drives give no torque: nothing is judged.";
  if (!now.judging) return "settling";
  return now.beyond.some((each) => each) ? "beyond its threshold" : "watching";
}

function statusContent(now) {
  const list = element("dl", { class: "live-status" });
  const add = (term, words) => list.append(element("div", {}, element("dt", {}, term), element("dd", {}, words)));
  add("Controller", controllerWords(now));
  add("Monitor", monitorWords(now));
  add("Time", `${formatNumber(now.t_s, ".1f")} s`);
  add("Pictures a second", String(picturesASecond()));
  const { missing, refused, lost, rejected, overflow } = now.counts;
  add("Samples missing, refused", `${missing}, ${refused}`);
  add("Frames lost, rejected", `${lost}, ${rejected}`);
  if (overflow > 0) add("Frames that this computer was too slow for", String(overflow));
  return list;
}

function picturesASecond() {
  const since = performance.now() - 1000;
  live.pictures = live.pictures.filter((at) => at >= since);
  return live.pictures.length;
}

/** Of what is judged by itself, a row each. */
function liveRows(now) {
  return live.setup.judged.map(({ name, unit }, at) => {
    const [residual, threshold] = [now.residual[at], now.threshold[at]];
    const ratio = residual === null || threshold === null ? null : residual / threshold;
    return [name, unit, residual, threshold, ratio, now.beyond[at] ? "beyond" : ""];
  });
}

/** Made once: a table that is read keeps its place and its focus. */
function liveTable(now) {
  const columns = [
    { name: "judged", unit: "" },
    { name: "unit", unit: "" },
    { name: "residual", unit: "", format: ".3g" },
    { name: "threshold", unit: "", format: ".3g" },
    { name: "residual / threshold", unit: "1", format: ".2f" },
    { name: "now", unit: "" },
  ];
  const rows = liveRows(now);
  const table = scrollingTable({ caption: "Residual and threshold now", columns, rows, note: "" });
  live.fillTable = (then) => {
    const lines = table.querySelectorAll("tbody tr");
    liveRows(then).forEach((row, at) => {
      row.forEach((value, of) => {
        const words = typeof value === "string" ? value : formatNumber(value, columns[of].format);
        lines[at].children[of].textContent = words;
      });
    });
  };
  return table;
}

function boundContent() {
  if (live.setup.has_bound) return [];
  return [
    noteWith(
      "warn",
      `${live.setup.robot.file} has no [uncertainty_bound]: the residual is shown without a threshold, and nothing is detected. `,
      "Record the healthy robot, then let ",
      element("code", {}, "offnominal calibrate"),
      " find the bound.",
    ),
  ];
}

function detectionWords(detection) {
  const who = detection.joint === null ? "" : `: ${jointName(detection.joint)}`;
  return `Off nominal since ${formatNumber(detection.t_s, ".2f")} s${who}.`;
}

function answerWords({ answer, joint }) {
  if (answer === null) {
    return joint === null ? "" : " Which fault it is will be said in a moment.";
  }
  return ` ${answer.words}${answer.decided ? "" : " (so far)"}.`;
}

function detectionContent({ detection, ended }) {
  if (detection === null) {
    const words = live.setup.has_bound
      ? "Nothing was detected yet. A detection keeps what was around it for a look."
      : "Without a bound nothing is detected.";
    return [element("p", { class: "empty" }, ended === "" ? words : ended)];
  }
  const note = noteWith("bad", element("b", {}, detectionWords(detection)), answerWords(detection));
  const controls = element("div", { class: "live-row" });
  const waits = detection.frozen ? {} : { "aria-disabled": "true" };
  controls.append(
    button("live-explain", "Explain this", liveActions.explain, { class: "action main", "data-free": "", ...waits }),
  );
  const words = detection.frozen
    ? `The analysis gets what came since the detection, up to ${live.setup.explained_s[1]} s: the more of it moves, the more it can tell.`
    : "What follows is still awaited …";
  return [note, controls, element("p", { class: "remark" }, words)];
}

/** Drawn anew only where it says something else. */
function showDetection(now) {
  const words = JSON.stringify([now.detection, now.ended]);
  if (words === live.detectionWords) return;
  live.detectionWords = words;
  replaceContent(places.detection, ...detectionContent(now));
  const { detection } = now;
  document.body.dataset.detection = detection === null ? "" : String(detection.number);
  if (detection === null) {
    hideFrozen();
    return;
  }
  if (detection.number !== live.told) {
    live.told = detection.number;
    say(detectionWords(detection));
  }
  if (detection.frozen && detection.number !== live.shown) {
    live.shown = detection.number;
    showFrozen().catch(complainLive);
  }
}

function hideFrozen() {
  live.shown = 0;
  places.frozen.parentElement.hidden = true;
}

/** What was around the detection, in charts that can be looked at. */
async function showFrozen() {
  const pixels = Math.min(8000, Math.max(100, places.livePicture.clientWidth));
  const { charts } = await ask("GET", `live/frozen?pixels=${pixels}`);
  places.frozen.parentElement.hidden = false;
  if (live.frozen.length === 0) {
    charts.forEach((block, at) => {
      places.frozen.append(figureElement(block, `frozen.${at}`));
      live.frozen.push(figures.at(-1));
    });
  } else {
    live.frozen.forEach((figure, at) => refill(figure, charts[at]));
  }
  shareExtents();
  live.frozen.forEach(drawFigure);
}

function recordingContent({ recording_s }) {
  const on = recording_s !== null;
  const most = live.setup.longest_recording_s;
  const full = on && recording_s >= most - 0.1;
  const words = full
    ? `Full: ${most} s are recorded. Stop to write them.`
    : on
      ? `Recording: ${formatNumber(recording_s, ".0f")} s.`
      : live.saved || `Into a CSV in the working directory, or beside the file of -o; ${most} s at most.`;
  return [
    button(
      "live-record",
      on ? "Stop and write the recording" : "Start a recording",
      on ? liveActions.stopRecording : liveActions.startRecording,
      { "data-free": "" },
    ),
    element("span", {}, words),
  ];
}

function showNumbers(now) {
  replaceContent(places.liveStatus, statusContent(now));
  if (live.fillTable === null) {
    places.liveNumbers.querySelector(".live-table").append(liveTable(now));
    watchTables(places.liveNumbers);
  }
  live.fillTable(now);
  const recording = JSON.stringify([now.recording_s === null ? null : Math.floor(now.recording_s), live.saved]);
  if (recording !== live.recordingWords) {
    live.recordingWords = recording;
    replaceContent(places.recordingRow, ...recordingContent(now));
  }
}

function complainLive(error) {
  const words = typeof error === "string" ? error : error.message;
  if (words === live.complaint) return;
  live.complaint = words;
  replaceContent(places.liveMessage, words === "" ? "" : noteWith("bad", words));
}

function takeMoment(now) {
  live.now = now;
  live.next = now.steps.next;
  appendSteps(live.curves, now.steps, live.setup.step_s);
  live.picture.draw(live.curves, live.curves[0].threshold.at(-1)?.[0] ?? 0);
  live.pictures.push(performance.now());
  document.body.dataset.pictures = String(Number(document.body.dataset.pictures ?? 0) + 1);
  showDetection(now);
  if (isBench()) {
    showInjected(now);
    document.getElementById("accommodation").setAttribute("aria-checked", String(now.accommodates));
  }
  if (performance.now() - live.numbersAt < kLiveNumbersMs) return;
  live.numbersAt = performance.now();
  showNumbers(now);
}

/** As long as the page is there: thirty times a second, and once where nobody sees it. */
async function followLive() {
  let failures = 0;
  let due = performance.now();
  for (;;) {
    try {
      takeMoment(await ask("GET", `live/now?from=${live.next}`));
      if (failures > 0) complainLive("");
      failures = 0;
    } catch (error) {
      complainLive(error);
      if (++failures > 20) return;
    }
    // What was late is made up for, but for more than a few pictures.
    const now = performance.now();
    due = Math.max(due + kLivePictureMs, now - 3 * kLivePictureMs);
    const wait = document.hidden || failures > 0 ? 1000 : due - now;
    await new Promise((done) => setTimeout(done, Math.max(0, wait)));
  }
}

async function act(work) {
  complainLive("");
  try {
    await work();
  } catch (error) {
    complainLive(error);
  }
}

const liveActions = {
  inject: (kind, joint, size) => act(() => ask("POST", "live/faults", { kind, joint, size })),
  endFaults: () => act(() => ask("DELETE", "live/faults")),
  accommodate: (on) => act(() => ask("POST", "live/accommodation", { on })),
  again: () => act(() => ask("POST", "live/again")),
  startRecording: () =>
    act(async () => {
      live.saved = "";
      await ask("POST", "live/recording");
    }),
  stopRecording: () =>
    act(async () => {
      const { saved } = await ask("DELETE", "live/recording");
      live.saved = `Written: ${saved}`;
      say(live.saved);
    }),
  explain: () =>
    act(async () => {
      say("The stretch is handed to the analysis.");
      const { saved, before } = await ask("POST", "live/explanation");
      live.saved = `Written: ${saved}, and of before the detection ${before}`;
      await live.onLoaded();
    }),
};

/** What was detected, and where a run has ended, stays until somebody says so. */
function againRow() {
  const [label, words] = isBench()
    ? ["Begin the run again", "from its start, healthy"]
    : ["Begin the monitor again", "what it has detected is forgotten"];
  const row = element("div", { class: "live-row" });
  row.append(button("live-again", label, liveActions.again, { "data-free": "" }), element("span", {}, words));
  return row;
}

/** Colours follow the page's mode, as the curves do. */
function liveLegend() {
  const list = element("ul", { class: "legend live-legend", "aria-hidden": "true" });
  const fill = () => {
    const { tones } = currentLook();
    list.replaceChildren(
      ...["residual", "threshold"].map((tone) => {
        const item = element("li");
        item.innerHTML = swatch({ kind: "line", tone }, tones[tone]);
        item.append(element("span", {}, tone));
        return item;
      }),
    );
  };
  fill();
  darkPreference.addEventListener("change", fill);
  return list;
}

function liveSection() {
  const frozen = element(
    "div",
    { hidden: "" },
    element("h3", {}, "Around the detection"),
    place("frozen", { class: "blocks" }),
  );
  const numbers = place("liveNumbers");
  numbers.append(element("details", { id: "live-numbers" }, element("summary", {}, "Numbers"), element("div", { class: "live-table" })));
  const what = live.setup.space === "torque"
    ? "Of every joint: the torque that the model does not explain, behind the estimator's filter, and the threshold that a healthy joint stays below."
    : "Measured velocity minus the estimator's, of all joints together, and the threshold that a healthy robot stays below.";
  // What is used stands above what comes and goes: it does not move from under a click.
  const controls = [];
  if (isBench()) {
    controls.push(element("h3", {}, "Faults"), ...benchContent(), accommodationSwitch());
  } else {
    controls.push(element("p", { class: "remark" }, "Studio listens on this bus. It has no way to send on it, a torque least of all."));
  }
  return sectionWith(
    "live",
    liveHeading(),
    element("p", { class: "remark" }, what),
    ...boundContent(),
    place("liveStatus"),
    ...controls,
    element("h3", {}, "Recording"),
    place("recordingRow", { class: "live-row" }),
    againRow(),
    place("liveMessage", { role: "alert" }),
    place("detection"),
    liveLegend(),
    place("livePicture", {
      class: "live-picture",
      role: "img",
      "aria-label": "Residual and threshold over the last ten seconds; the same as numbers below",
    }),
    numbers,
    frozen,
  );
}

/** Puts the live view on the page; `onLoaded`: called when a stretch was handed to the analysis. */
function startLive(setup, host, onLoaded) {
  live.setup = setup;
  live.onLoaded = onLoaded;
  live.curves = emptyCurves(setup.judged.length);
  host.append(liveSection());
  live.picture = new LivePicture(places.livePicture, setup.judged);
  live.picture.begin();
  document.body.dataset.live = setup.source;
  followLive();
}
