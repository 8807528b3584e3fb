import { byId, element, within } from "../report/element";
import { formatNumber } from "../report/format";
import { currentLook, darkPreference } from "../report/look";
import { swatch } from "../report/palette";
import { watchTables } from "../report/tables";
import type { LiveSetup, Moment } from "./api";
import { complainLive, liveActions } from "./live_actions";
import { accommodationSwitch, benchContent, showInjected } from "./live_bench";
import { LivePicture } from "./live_charts";
import { appendSteps, emptyCurves } from "./live_curves";
import { showDetection } from "./live_detection";
import { isBench, live, liveSetup } from "./live_state";
import { boundContent, liveHeading, liveTable, statusContent } from "./live_words";
import { button, replaceContent, sectionWith } from "./parts";
import { place, placeOf } from "./places";
import { ask } from "./server";

/** How often the page asks what is new, and draws it: ms. */
const kLivePictureMs = 1000 / 30;

/** Numbers that change faster nobody reads. */
const kLiveNumbersMs = 250;

function recordingContent({ recording_s }: Moment) {
  const on = recording_s !== null;
  const most = liveSetup().longest_recording_s;
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

function showNumbers(now: Moment) {
  replaceContent(placeOf("liveStatus"), statusContent(now));
  if (live.fillTable === null) {
    within(placeOf("liveNumbers"), ".live-table").append(liveTable(now));
    watchTables(placeOf("liveNumbers"));
  }
  live.fillTable?.(now);
  const recording = JSON.stringify([now.recording_s === null ? null : Math.floor(now.recording_s), live.saved]);
  if (recording !== live.written.recording) {
    live.written.recording = recording;
    replaceContent(placeOf("recordingRow"), ...recordingContent(now));
  }
}

function takeMoment(now: Moment) {
  live.now = now;
  live.next = now.steps.next;
  appendSteps(live.curves, now.steps, liveSetup().step_s);
  live.picture?.draw(live.curves, live.curves[0]?.threshold.at(-1)?.[0] ?? 0);
  live.pictures.push(performance.now());
  document.body.dataset.pictures = String(Number(document.body.dataset.pictures ?? 0) + 1);
  takeSession(now);
  showDetection(now);
  if (isBench()) {
    showInjected(now);
    byId("accommodation").setAttribute("aria-checked", String(now.accommodates));
  }
  if (performance.now() - live.numbersAt < kLiveNumbersMs) return;
  live.numbersAt = performance.now();
  showNumbers(now);
}

/** Another page over the same live view may have begun a session: this one takes it up by itself. */
function takeSession({ session }: Moment) {
  if (live.session === null || session === live.session) return;
  live.session = session;
  live.onLoaded(false).catch(complainLive);
}

/** As long as the page is there: thirty times a second, and once where nobody sees it. */
async function followLive() {
  let failures = 0;
  let due = performance.now();
  for (;;) {
    try {
      takeMoment(await ask("GET", "/live/now", { query: { from: live.next } }));
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

/** What was detected, and where a run has ended, stays until somebody says so. */
function againRow() {
  const [label, words] = isBench()
    ? ["Begin the run again", "from its start, healthy"]
    : ["Begin the monitor again", "what it has detected is forgotten"];
  const row = element("div", { class: "live-row" });
  row.append(button("live-again", label, liveActions.again, { "data-free": "" }), element("span", {}, words));
  return row;
}

const kLines = [
  ["residual", "residual", false],
  ["threshold", "threshold", true],
  ["level to act", "faint", true],
] as const;

/** Colours follow the page's mode, as the curves do. */
function liveLegend() {
  const list = element("ul", { class: "legend live-legend", "aria-hidden": "true" });
  const fill = () => {
    const { tones } = currentLook();
    const there = liveSetup().has_two_levels ? kLines : kLines.slice(0, 2);
    list.replaceChildren(
      ...there.map(([name, tone, dashed]) => {
        const item = element("li");
        item.innerHTML = swatch({ kind: "line", tone, dashed }, tones[tone]);
        item.append(element("span", {}, name));
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
    { id: "live-frozen", hidden: "" },
    element("h3", {}, "Around the detection"),
    place("frozen", { class: "blocks" }),
  );
  const numbers = place("liveNumbers");
  numbers.append(element("details", { id: "live-numbers" }, element("summary", {}, "Numbers"), element("div", { class: "live-table" })));
  const what = liveSetup().space === "torque"
    ? "Of every joint: the torque that the model does not explain, behind the estimator's filter, and the threshold that a healthy joint stays below."
    : "Measured velocity minus the estimator's, of all joints together, and the threshold that a healthy robot stays below.";
  const acts = liveSetup().has_two_levels ? " Beyond the level to act a controller does more than to report." : "";
  // What is used stands above what comes and goes: it does not move from under a click.
  const controls: HTMLElement[] = [];
  if (isBench()) {
    controls.push(element("h3", {}, "Faults"), ...benchContent(), accommodationSwitch());
  } else {
    controls.push(element("p", { class: "remark" }, "Studio listens on this bus. It has no way to send on it, a torque least of all."));
  }
  return sectionWith(
    "live",
    liveHeading(),
    element("p", { class: "remark" }, what + acts),
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
export function startLive(setup: LiveSetup, host: HTMLElement, onLoaded: (isOwn: boolean) => Promise<void>) {
  live.setup = setup;
  live.session = setup.session;
  live.onLoaded = onLoaded;
  live.curves = emptyCurves(setup.judged.length);
  host.append(liveSection());
  live.picture = new LivePicture(placeOf("livePicture"), setup.judged);
  live.picture.begin();
  document.body.dataset.live = setup.source;
  void followLive();
}
