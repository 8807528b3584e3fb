import { element, within, type Child } from "../report/element";
import { hiddenText } from "../report/words";
import type { LoadRecording, LoadRobot, LoadState, LoadUrdf, SignalEdit, SignalMap, WrittenAtRest } from "./api";
import { isRobotFile, jointsWords, sizeWords } from "./files";
import { chainElement } from "./load_chain";
import { filesElement } from "./load_files";
import { mapContent, showPreview } from "./load_map";
import { payloadElement } from "./load_payload";
import { addToNote, button, foldWith, holdControls, noteWith, replaceContent, sectionWith } from "./parts";
import { place, placeOf } from "./places";
import { ask, mayConfirm, wordsOf } from "./server";

/** Files that the page is given: what there is, and what is under way. */
export const load: {
  /** What the server last said; null: the files are those of the command line. */
  state: LoadState | null;
  doing: string;
  message: string | null;
  written: string[];
  /** What was written of hold maps just now. */
  atRest: WrittenAtRest | null;
  /** What was refused is done where it is asked once more. */
  confirm: boolean;
  onSession: () => Promise<void>;
} = {
  state: null,
  doing: "",
  message: null,
  written: [],
  atRest: null,
  confirm: false,
  onSession: async () => {},
};

export function loadState(): LoadState {
  if (load.state === null) throw new Error("the files are those of the command line");
  return load.state;
}

function dropElement() {
  const { limits } = loadState();
  const input = element("input", { type: "file", id: "load-input", multiple: "", hidden: "" });
  input.addEventListener("change", () => {
    const files = [...(input.files ?? [])];
    input.value = "";
    void takeFiles(files);
  });
  const words = element("p", { class: "drop-words" }, "Drop recordings and a robot file here");
  const root = element("div", { class: "drop", id: "load-drop" }, words, input);
  root.append(
    element("p", {}, "or ", button("load-choose", "Choose files", () => input.click(), { class: "action main" })),
    element(
      "p",
      { class: "remark" },
      "Recordings: CSV, MATLAB .mat, candump. The robot: a robot file (.toml) or a URDF (.urdf). At most " +
        `${limits.file_words} a file, ${limits.all_words} together. Nothing leaves this machine.`,
    ),
  );
  return root;
}

/** The page is one place to drop files on: beside it the browser would open them. */
function watchDrops() {
  const carriesFiles = (event: DragEvent) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  const mark = (on: boolean) => document.getElementById("load-drop")?.toggleAttribute("data-over", on);
  window.addEventListener("dragover", (event) => {
    if (!carriesFiles(event)) return;
    event.preventDefault();
    mark(true);
  });
  window.addEventListener("dragleave", (event) => {
    if (event.relatedTarget === null) mark(false);
  });
  window.addEventListener("drop", (event) => {
    if (!carriesFiles(event)) return;
    event.preventDefault();
    mark(false);
    unfoldLoad();
    void takeFiles([...(event.dataTransfer?.files ?? [])]);
  });
}

/** One after the other, the robot first: with it the columns are guessed. What fails is said, the others are taken. */
async function takeFiles(files: File[]) {
  while (load.doing !== "") await new Promise((done) => setTimeout(done, 100));
  const sorted = [...files].sort((a, b) => Number(isRobotFile(b.name)) - Number(isRobotFile(a.name)));
  const { limits } = loadState();
  const refused: string[] = [];
  await loadChange(async () => {
    for (const file of sorted) {
      showDoing(`Reading ${file.name} …`);
      try {
        if (file.size > limits.file) {
          throw new Error(`${file.name}: a file of ${sizeWords(file.size)}; allowed: ${limits.file_words} a file on the page; to mend: start Studio with it on the command line`);
        }
        load.state = await ask("POST", "/load/files", { query: { name: file.name }, file });
      } catch (error) {
        refused.push(wordsOf(error));
      }
    }
    showDoing("");
    if (refused.length > 0) throw new Error(refused.join("\n"));
  });
}

/** One at a time; what fails is said, and nothing else has changed. */
export async function loadChange(work: () => Promise<void>) {
  if (load.doing !== "") return;
  load.doing = "…";
  load.message = null;
  load.atRest = null;
  load.confirm = false;
  holdControls(true);
  try {
    await work();
  } catch (error) {
    load.message = wordsOf(error);
    load.confirm = mayConfirm(error);
  }
  load.doing = "";
  showLoad();
  holdControls(false);
  if (load.message !== null) placeOf("loadMessage").scrollIntoView({ block: "nearest" });
  await showPreview();
}

function showDoing(words: string) {
  load.doing = words || "…";
  replaceContent(placeOf("loadDoing"), words === "" ? "" : element("p", { class: "progress" }, element("span", { class: "spinner", "aria-hidden": "true" }), words));
}

export const loadActions = {
  remove: (id: number) => loadChange(async () => {
    load.state = await ask("DELETE", "/load/files/{id}", { path: { id } });
  }),
  holdOut: (id: number, heldOut: boolean) => loadChange(async () => {
    load.state = await ask("POST", "/load/held_out", { body: { recording: id, held_out: heldOut } });
  }),
  signal: (edit: SignalEdit) => loadChange(async () => {
    load.state = await ask("POST", "/load/signal", { body: edit });
  }),
  atRest: (atRest: boolean) => loadChange(async () => {
    load.state = await ask("POST", "/load/at_rest", { body: { at_rest: atRest } });
  }),
  write: () => loadChange(async () => {
    load.atRest = await ask("POST", "/load/written");
  }),
  guess: () => loadChange(async () => {
    load.state = await ask("POST", "/load/guess");
  }),
  use: (replace: boolean) => loadChange(async () => {
    showDoing("Reading and examining the recordings …");
    try {
      load.written = (await ask("POST", "/load/session", { body: { replace } })).written;
      await load.onSession();
      foldLoad(true);
    } finally {
      showDoing("");
    }
  }),
};

type Line = (done: boolean, title: string, ...words: Child[]) => HTMLElement;

function robotLine(line: Line, robot: LoadRobot | null, urdf: LoadUrdf | null) {
  const words = robot === null ? "" : `${robot.file}, “${robot.name}”, ${jointsWords(robot.joints.length)}`;
  if (urdf !== null && urdf.chosen === null) {
    const before = robot === null ? "" : ` Until then the robot is ${words}.`;
    return line(false, "The robot’s chain.", `${urdf.file} has several chains of joints: choose the one that was recorded.${before}`, chainElement(urdf));
  }
  if (urdf !== null) return line(true, "Robot:", words, chainElement(urdf));
  if (robot !== null) return line(true, "Robot:", words);
  return line(false, "A robot file.", "What is known of the arm: ", element("code", {}, ".toml"), ", or a URDF to make one of. Without either, ", element("code", {}, "offnominal new"), " begins one from a table of lengths and masses.");
}

/** What the columns were told by: where no position, velocity or torque has one, by nothing. */
function columnsWords(map: SignalMap | null) {
  if (map === null) return "Guessed once both are there, shown, and put right below.";
  const isTold = map.signals.some(({ joint, source }) => joint !== null && source !== "");
  return isTold ? `Told by ${map.from}; look at them below, then use them.` : "No column's name tells which signal it is: say so below.";
}

/** What is there, and what comes next: a line each. */
function stepsContent({ robot, urdf, recordings, map }: LoadState) {
  let number = 0;
  const line: Line = (done, title, ...words) => {
    const mark = element("span", { class: "mark", "aria-hidden": "true" }, done ? "✓" : String(++number));
    const told = element("div", {}, element("b", {}, title), hiddenText(done ? "done" : "still to do"), " ", ...words);
    return element("li", { class: done ? "done" : "" }, mark, told);
  };
  const list = element("ol", { class: "load-steps" });
  list.append(robotLine(line, robot, urdf));
  const wanted = "Time, position and torque or motor current of every joint while the arm moves; several will do. Velocities are welcome. Positions in one file and torques in another are one recording.";
  const none = recordings.length === 0;
  list.append(none ? line(false, "A recording.", wanted) : line(true, "Recordings:", recordingList(recordings)));
  const ready = map !== null && map.missing.length === 0;
  list.append(
    line(ready, "What the columns are.", columnsWords(map)),
  );
  return list;
}

function recordingList(recordings: LoadRecording[]) {
  const list = element("ul", { class: "load-recordings" });
  for (const recording of recordings) {
    const { id, name, bytes, held_out: heldOut } = recording;
    const box = element("input", { type: "checkbox", id: `held-out-${id}` });
    box.checked = heldOut;
    box.addEventListener("change", () => loadActions.holdOut(id, box.checked));
    const remove = button(`remove-${id}`, "Remove", () => loadActions.remove(id));
    remove.append(element("span", { class: "hidden-text" }, ` ${name}`));
    const label = element("label", { for: `held-out-${id}` }, box, " hold out", element("span", { class: "hidden-text" }, ` ${name}`));
    const row = element("li", {}, element("span", { class: "file-name" }, name), element("span", { class: "soft" }, sizeWords(bytes)), label, remove);
    if (recording.why_joined !== "") row.append(element("span", { class: "soft joined-why" }, `taken for one recording: ${recording.why_joined}`));
    row.append(filesElement(recording) ?? "", payloadElement(recording));
    list.append(row);
  }
  return list;
}

function loadMessageContent() {
  const content: HTMLElement[] = [];
  if (load.message !== null) {
    for (const words of load.message.split("\n")) content.push(noteWith(load.confirm ? "warn" : "bad", words));
    const last = content.at(-1);
    if (load.confirm && last) addToNote(last, " ", button("use-anyway", "Begin anew", () => loadActions.use(true)));
  }
  if (load.written.length > 0) content.push(noteWith("good", `Written: ${load.written.join(", ")}`));
  if (load.atRest !== null) content.push(...writtenAtRest(load.atRest));
  return content;
}

/** No session is over hold maps: what was written of them, and the commands that search them. */
function writtenAtRest({ written, commands, note }: WrittenAtRest) {
  const words = written.length === 0 ? "All that is needed is there already." : `Written: ${written.join(", ")}.`;
  const lines = element("pre", { tabindex: "0", id: "at-rest-commands", "aria-label": "The commands that search the hold maps" }, commands.join("\n"));
  return [noteWith("good", `${words} These say what the model lacks at rest, and write a robot file with it:`), lines, element("p", { class: "remark" }, note)];
}

/** With a session there is more to see than its files. */
function foldLoad(folded: boolean) {
  const fold = within<HTMLDetailsElement>(document, "#load-fold");
  fold.open = !folded;
  fold.toggleAttribute("data-foldable", folded);
}

function unfoldLoad() {
  within<HTMLDetailsElement>(document, "#load-fold").open = true;
}

export function showLoad() {
  const given = loadState();
  if (placeOf("desk").hidden) {
    const title = given.robot === null ? "Studio" : `Studio: ${given.robot.name}`;
    document.title = given.robot === null ? "offnominal Studio" : title;
    const header = element("header", {}, element("h1", {}, title));
    header.append(element("p", { class: "subtitle" }, "Recordings of a robot and the file of its model: what the model misses, and which effect makes up for it."));
    replaceContent(placeOf("head"), header);
  }
  replaceContent(placeOf("loadSteps"), stepsContent(given));
  replaceContent(placeOf("loadMessage"), ...loadMessageContent());
  const notes = given.robot?.notes ?? [];
  replaceContent(placeOf("loadNotes"), notes.length === 0 ? "" : foldedList("robot-notes", `What the URDF's import merged, left out or assumed (${notes.length})`, notes));
  replaceContent(placeOf("loadMap"), ...(given.map === null ? [] : mapContent(given, given.map)));
  if (load.doing !== "") holdControls(true);
}

export function foldedList(id: string, title: string, lines: string[]) {
  const list = element("ul");
  for (const words of lines) list.append(element("li", {}, words));
  const fold = foldWith(id, title);
  fold.append(list);
  return fold;
}

/** A page that is given its files: where they are dropped stays, folded up once there is a session. */
export async function startLoad(host: HTMLElement, loaded: boolean, onSession: () => Promise<void>) {
  load.onSession = onSession;
  load.state = await ask("GET", "/load");
  const fold = element("details", { id: "load-fold" }, element("summary", { id: "load-fold-summary" }, "Files and columns"));
  fold.append(
    dropElement(),
    place("loadDoing", { role: "status" }),
    place("loadSteps"),
    place("loadNotes"),
    place("loadMap"),
  );
  host.append(sectionWith("load", "Recordings and robot", place("loadMessage", { role: "alert" }), fold));
  foldLoad(loaded);
  watchDrops();
  showLoad();
  document.body.dataset.load = "";
  await showPreview();
}
