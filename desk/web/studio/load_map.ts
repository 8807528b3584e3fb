import { element, type Child } from "../report/element";
import { itemAt } from "../report/lists";
import type {
  DataFault,
  Findings,
  LoadJoint,
  LoadState,
  Preview,
  PreviewSignal,
  Side,
  Signal,
  SignalMap,
} from "./api";
import { selectWith, type Choice } from "./choices";
import { foldedList, loadActions, loadState, showLoad } from "./load";
import { baseName, button, effectTitle, noteWith, percent } from "./parts";
import { ask, wordsOf } from "./server";
import { columnOptions, editOf, signalWords, type Change } from "./signals";
import { sketchElement, sketchLegend, type Curve } from "./sketch";

/** What the columns are: of the recording that is shown, as the server last read it. */
export const mapView: {
  recording: number;
  preview: Preview | null;
  findings: Findings | null;
  failed: string | null;
  asked: number;
} = { recording: 0, preview: null, findings: null, failed: null, asked: 0 };

const kSideWords: Record<Side, string> = {
  joint: "of the joint",
  motor: "of its motor",
  current: "current of its motor",
  sensor: "of a sensor behind the gear",
};

const kPreviewPixels = 300;

const kAtRestWords =
  "There is no session over hold maps: its error, its charts and the data doctor are of motion. Write these, and explain says what the model lacks at rest, cogging above all. Approach the positions from both sides, or friction cannot be told from it.";

function idOf({ quantity, joint, file }: Signal): string {
  if (joint !== null) return `signal-${quantity}-${joint}`;
  return file === null || file === 1 ? "signal-time" : `signal-time-${file}`;
}

/** Column, unit and sign; the rest one click away. */
function signalControls(signal: Signal, columns: string[]) {
  const id = idOf(signal);
  const words = signalWords(signal);
  const change = (what: Change) => loadActions.signal(editOf(signal, what));
  const root = element("div", { class: "signal-controls" });
  root.append(
    selectWith(`${id}-source`, `Column of ${words}`, columnOptions(signal, columns), signal.source, (source) => change({ source })),
  );
  if (signal.source === "" && signal.more === "") return root;
  root.append(
    selectWith(`${id}-unit`, `Unit of ${words}`, signal.units.map((unit): Choice => [unit, unit]), signal.unit, (unit) => change({ unit })),
  );
  if (signal.joint === null) return root;
  const sign = element("input", { type: "checkbox", id: `${id}-sign` });
  sign.checked = signal.scale < 0;
  sign.addEventListener("change", () => change({ scale: -signal.scale }));
  root.append(element("label", { for: `${id}-sign` }, sign, " sign turned", element("span", { class: "hidden-text" }, ` of ${words}`)));
  root.append(moreControls(signal, id, change));
  return root;
}

function moreControls(signal: Signal, id: string, change: (what: Change) => void) {
  const words = signalWords(signal);
  const factor = element("input", { type: "number", step: "any", id: `${id}-scale`, value: String(Math.abs(signal.scale)) });
  factor.addEventListener("change", () => {
    const value = Number(factor.value);
    if (factor.value !== "" && value > 0) change({ scale: Math.sign(signal.scale) * value });
  });
  const row = element("div", { class: "signal-more" });
  row.append(
    element("label", { for: `${id}-scale` }, "times ", factor),
    selectWith(`${id}-of`, `What ${words} is of`, signal.sides.map((side): Choice => [side, kSideWords[side]]), signal.of, (of) => change({ of: of as Side })),
  );
  if (signal.more !== "") row.append(element("span", { class: "soft" }, `and, as the robot file has it, ${signal.more}`));
  // What is not as everywhere is seen without a click.
  if (Math.abs(signal.scale) !== 1 || signal.of !== "joint" || signal.more !== "") return row;
  const summary = element("summary", { id: `${id}-more-summary` }, "More", element("span", { class: "hidden-text" }, ` of ${words}`));
  return element("details", { id: `${id}-more` }, summary, row);
}

/** What the curve should meet. */
function otherOf(signal: Signal, drawn: PreviewSignal): Curve | null {
  if (signal.quantity === "velocity" && drawn.derived.length > 0) return { t_s: drawn.derived_t_s ?? [], values: drawn.derived };
  if (signal.quantity !== "torque" || mapView.findings === null) return null;
  const found = mapView.findings.joints.find(({ joint }) => joint === signal.joint);
  return found === undefined ? null : { t_s: found.t_s, values: found.model };
}

function signalRow(signal: Signal, columns: string[]) {
  const row = element("div", { class: "signal" });
  const head = element("div", { class: "signal-head" }, element("h4", {}, effectTitle(signal.quantity)), signalControls(signal, columns));
  row.append(head);
  const drawn = mapView.preview?.signals.find((each) => each.quantity === signal.quantity && each.joint === signal.joint);
  if (drawn !== undefined) row.append(sketchElement(drawn, otherOf(signal, drawn), effectTitle(signalWords(signal))));
  return row;
}

function findingNote(fault: DataFault) {
  const note = noteWith(fault.spoils ? "bad" : "warn", `${fault.words}. To mend: ${fault.mend}.`);
  note.dataset.finding = fault.fault;
  return note;
}

function jointCard({ joint, name }: LoadJoint, signals: Signal[], columns: string[]) {
  const found = mapView.findings?.joints.find((each) => each.joint === joint);
  const head = element("div", { class: "step-head" }, element("h3", {}, `${joint}. ${name}`));
  if (found !== undefined) head.append(element("span", { class: "fall" }, "error of the robot file ", element("b", {}, percent(found.error_percent))));
  const card = element("section", { class: "card joint-card", "aria-label": `Joint ${joint}` }, head);
  const grid = element("div", { class: "signals" });
  const isRead = ({ quantity }: Signal) => quantity !== "velocity" || !loadState().map?.at_rest;
  for (const signal of signals.filter((each) => each.joint === joint && isRead(each))) grid.append(signalRow(signal, columns));
  card.append(grid);
  for (const fault of mapView.findings?.faults.filter((each) => each.joint === joint) ?? []) card.append(findingNote(fault));
  return card;
}

/** A hold map is another kind of recording: it has no time, and no session is over it. */
function atRestRow({ at_rest: atRest }: SignalMap) {
  const box = element("input", { type: "checkbox", id: "at-rest" });
  box.checked = atRest;
  box.addEventListener("change", () => loadActions.atRest(box.checked));
  const label = element("label", { for: "at-rest" }, box, " readings at rest, one held position after the other (a hold map)");
  const row = element("div", { class: "signal-row signal-controls" }, label);
  if (!atRest) return row;
  const read = mapView.preview?.sampling ?? "";
  row.append(element("span", { class: "soft" }, `${read === "" ? "" : `${read}. `}Time and velocities are not read; curves are over the readings, in their order.`));
  return row;
}

/** The time of every file; of several, when each clock began, and which file it is of. */
function clockRows(map: SignalMap, given: LoadState) {
  const times = map.signals.filter(({ joint }) => joint === null);
  const shown = given.recordings.find(({ id }) => id === mapView.recording);
  return times.map((time, at) => {
    const name = shown?.files[at]?.name ?? `file ${at + 1}`;
    const row = clockRow(time, itemAt(map.columns_of_files, at), times.length === 1 ? "Time" : `Time in ${name}`);
    // The others are put on the clock of the first.
    if (at > 0 || time.offset_s !== 0) row.append(offsetControl(time, name));
    if (at === 0) row.append(...periodControls(map));
    return row;
  });
}

function clockRow(time: Signal, columns: string[], title: string) {
  return element("div", { class: "signal-row" }, element("h3", {}, title), signalControls(time, columns));
}

/** Clocks of several files need not begin together. */
function offsetControl(time: Signal, name: string) {
  const id = `${idOf(time)}-offset`;
  const offset = element("input", { type: "number", step: "any", id, value: String(time.offset_s ?? 0) });
  offset.addEventListener("change", () => {
    if (offset.value !== "") loadActions.signal(editOf(time, { offset_s: Number(offset.value) }));
  });
  return element("label", { for: id }, "plus ", element("span", { class: "hidden-text" }, `, for the clock of ${name}, `), offset, " s");
}

function periodControls(map: SignalMap) {
  const row: HTMLElement[] = [];
  const period = element("input", { type: "number", step: "any", id: "signal-period", value: map.period_s === null ? "" : String(map.period_s), placeholder: "no" });
  period.addEventListener("change", () => loadActions.signal({ quantity: "time", period_s: Number(period.value) }));
  row.push(element("label", { for: "signal-period" }, "or a sample every ", period, " s"));
  if (mapView.preview?.sampling) row.push(element("span", { class: "soft" }, mapView.preview.sampling));
  return row;
}

function shownRecording(given: LoadState) {
  const { recordings } = given;
  if (!recordings.some(({ id }) => id === mapView.recording)) mapView.recording = itemAt(recordings, 0).id;
  if (recordings.length === 1) return "";
  const select = selectWith("preview-recording", "Recording that is shown", recordings.map(({ id, name }): Choice => [String(id), name]), String(mapView.recording), (id) => {
    mapView.recording = Number(id);
    mapView.preview = mapView.findings = null;
    showLoad();
    void showPreview();
  });
  return element("div", { class: "choice-row" }, element("span", {}, "Shown:"), select, element("span", { class: "soft" }, "the same columns are read of all of them"));
}

export function mapContent(given: LoadState, map: SignalMap): Child[] {
  const shown = shownRecording(given);
  const content: Child[] = [element("h3", { class: "map-heading", id: "map-heading" }, "What the columns are")];
  content.push(...keptContent(given));
  content.push(element("p", {}, "Every signal as it is read: at the joint, in SI units. Where a curve does not look like the arm's, choose another column, its unit or its sign: the picture follows."), shown);
  const wrong = mapView.preview?.error ?? null;
  if (wrong !== null) content.push(noteWith("bad", wrong));
  const whole = mapView.findings?.faults.filter((fault) => fault.joint === null) ?? [];
  content.push(atRestRow(map), ...(map.at_rest ? [] : clockRows(map, given)), ...whole.map(findingNote), map.at_rest ? "" : sketchLegend());
  const cards = element("div", { class: "joint-cards" });
  for (const joint of given.robot?.joints ?? []) cards.append(jointCard(joint, map.signals, map.columns));
  content.push(cards, ...saidContent(map), useContent(map, mapView.preview !== null && wrong === null));
  return content;
}

/** What was said of the same columns before, and why what is said now is not kept. */
function keptContent({ kept }: LoadState): HTMLElement[] {
  const content: HTMLElement[] = [];
  if (kept.taken_up !== "") content.push(noteWith("neutral", `Said of these columns before, and taken up from ${baseName(kept.file)}: ${kept.taken_up}. “Guess again” forgets it.`));
  if (kept.problem !== "") content.push(noteWith("warn", `What is said of these files is not kept: ${kept.problem}`));
  return content;
}

/** What the guess, the reader and the doctor have to say. */
function saidContent(map: SignalMap): HTMLElement[] {
  const content: HTMLElement[] = [];
  const { preview, findings, failed } = mapView;
  const why = failed ?? findings?.error ?? null;
  if (map.at_rest && preview?.error === null) content.push(noteWith("neutral", kAtRestWords));
  else if (why !== null) content.push(noteWith("warn", why));
  else if (findings === null && preview?.error === null) content.push(element("p", { class: "soft" }, "The data doctor is looking at it …"));
  if (findings !== null && !map.at_rest && findings.faults.length === 0) {
    content.push(noteWith("good", "The data doctor finds nothing wrong: units, signs, gaps, jumps and the like."));
  }
  const lines = [...map.notes, ...(mapView.preview?.remarks ?? [])];
  if (map.without_numbers.length > 0) lines.push(`Columns without numbers: ${map.without_numbers.join(", ")}`);
  if (lines.length > 0) content.push(foldedList("map-notes", `Remarks on the columns (${lines.length})`, lines));
  return content;
}

function useContent(map: SignalMap, fine: boolean) {
  const root = element("div", { class: "use" });
  // What the model cannot be compared with no session takes; why stands above.
  const refused = !map.at_rest && (mapView.findings?.error ?? null) !== null;
  const ready = fine && !refused && map.missing.length === 0;
  const spoilt = mapView.findings?.faults.some(({ spoils }) => spoils) ?? false;
  root.append(
    button("use-these", map.at_rest ? "Write these" : "Use these", () => (map.at_rest ? loadActions.write() : loadActions.use(false)), { class: "action main", ...(ready ? {} : { "aria-disabled": "true" }) }),
    button("guess-again", "Guess again", loadActions.guess),
  );
  if (spoilt) root.append(element("span", { class: "soft" }, "A session refuses what is marked red."));
  const takers = map.at_rest ? "Write these writes this file, which explain and add --all-found take" : "Use these writes this file, which every verb takes";
  const words = map.is_of_robot
    ? "The robot file's own [channels] read it, and stay as they are."
    : `${takers} as --channels; or paste it into the robot file:`;
  const text = map.text === null || map.is_of_robot ? "" : element("pre", { tabindex: "0", "aria-label": "The [channels] that are written" }, map.text.trim());
  return element("div", {}, root, element("p", { class: "remark" }, words), text);
}

/** The curves, and then what takes longer; an answer that comes late is of no use. */
export async function showPreview() {
  if (loadState().map === null) return;
  const asked = ++mapView.asked;
  const said = { query: { recording: mapView.recording, pixels: kPreviewPixels } };
  const isLate = () => asked !== mapView.asked;
  /** Null: there is none, or it comes late. */
  const shown = async <Answer>(question: Promise<Answer>, keep: (answer: Answer | null) => void) => {
    const [answer, failed] = await question.then(
      (given): [Answer, null] => [given, null],
      (error): [null, string] => [null, wordsOf(error)],
    );
    if (isLate()) return null;
    keep(answer);
    mapView.failed = failed;
    showLoad();
    return answer;
  };
  mapView.findings = null;
  const preview = await shown(ask("GET", "/load/preview", said), (answer) => (mapView.preview = answer));
  if (preview !== null && preview.error === null) {
    await shown(ask("GET", "/load/findings", said), (answer) => (mapView.findings = answer));
  }
  if (!isLate()) document.body.dataset.load = String(loadState().revision);
}
