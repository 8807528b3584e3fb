/** Files that the page is given: what there is, and what is under way. */
const load = {
  /** What the server last said; null: the files are those of the command line. */
  state: null,
  doing: "",
  message: null,
  written: [],
  confirm: false,
  onSession: async () => {},
};

const kRobotKinds = [".toml", ".urdf"];

function isRobotFile(name) {
  return kRobotKinds.some((kind) => name.toLowerCase().endsWith(kind));
}

function sizeWords(bytes) {
  const units = ["bytes", "KiB", "MiB", "GiB"];
  let at = 0;
  while (bytes >= 1024 && at < units.length - 1) {
    bytes /= 1024;
    ++at;
  }
  return `${formatSignificant(bytes, 3)} ${units[at]}`;
}

function dropElement() {
  const input = element("input", { type: "file", id: "load-input", multiple: "", hidden: "" });
  input.addEventListener("change", () => {
    const files = [...input.files];
    input.value = "";
    takeFiles(files);
  });
  const words = element("p", { class: "drop-words" }, "Drop recordings and a robot file here");
  const root = element("div", { class: "drop", id: "load-drop" }, words, input);
  root.append(
    element("p", {}, "or ", button("load-choose", "Choose files", () => input.click(), { class: "action main" })),
    element(
      "p",
      { class: "remark" },
      "Recordings: CSV, MATLAB .mat, candump. The robot: a robot file (.toml) or a URDF (.urdf). At most " +
        `${load.state.limits.file_words} a file, ${load.state.limits.all_words} together. Nothing leaves this machine.`,
    ),
  );
  return root;
}

/** The page is one place to drop files on: beside it the browser would open them. */
function watchDrops() {
  const carriesFiles = (event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  const mark = (on) => document.getElementById("load-drop")?.toggleAttribute("data-over", on);
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
    document.getElementById("load-fold").open = true;
    takeFiles([...event.dataTransfer.files]);
  });
}

/** One after the other, the robot first: with it the columns are guessed. What fails is said, the others are taken. */
async function takeFiles(files) {
  while (load.doing !== "") await new Promise((done) => setTimeout(done, 100));
  const sorted = [...files].sort((a, b) => Number(isRobotFile(b.name)) - Number(isRobotFile(a.name)));
  const refused = [];
  await loadChange(async () => {
    for (const file of sorted) {
      showDoing(`Reading ${file.name} …`);
      try {
        if (file.size > load.state.limits.file) {
          throw new Error(`${file.name}: a file of ${sizeWords(file.size)}; allowed: ${load.state.limits.file_words} a file on the page; to mend: start Studio with it on the command line`);
        }
        load.state = await handOver(file);
      } catch (error) {
        refused.push(error.message);
      }
    }
    showDoing("");
    if (refused.length > 0) throw new Error(refused.join("\n"));
  });
}

/** One at a time; what fails is said, and nothing else has changed. */
async function loadChange(work) {
  if (load.doing !== "") return;
  load.doing = "…";
  load.message = null;
  load.confirm = false;
  holdControls(true);
  try {
    await work();
  } catch (error) {
    load.message = error.message;
    load.confirm = error.confirm === true;
  }
  load.doing = "";
  showLoad();
  holdControls(false);
  if (load.message !== null) places.loadMessage.scrollIntoView({ block: "nearest" });
  await showPreview();
}

function showDoing(words) {
  load.doing = words || "…";
  replaceContent(places.loadDoing, words === "" ? "" : element("p", { class: "progress" }, element("span", { class: "spinner", "aria-hidden": "true" }), words));
}

const loadActions = {
  remove: (id) => loadChange(async () => {
    load.state = await ask("DELETE", `load/files/${id}`);
  }),
  holdOut: (id, heldOut) => loadChange(async () => {
    load.state = await ask("POST", "load/held_out", { recording: id, held_out: heldOut });
  }),
  signal: (edit) => loadChange(async () => {
    load.state = await ask("POST", "load/signal", edit);
  }),
  guess: () => loadChange(async () => {
    load.state = await ask("POST", "load/guess");
  }),
  use: (replace) => loadChange(async () => {
    showDoing("Reading and examining the recordings …");
    try {
      load.written = (await ask("POST", "load/session", { replace })).written;
      await load.onSession();
      foldLoad(true);
    } finally {
      showDoing("");
    }
  }),
};

/** What is there, and what comes next: a line each. */
function stepsContent({ robot, recordings, map }) {
  let number = 0;
  const line = (done, title, ...words) => {
    const mark = element("span", { class: "mark", "aria-hidden": "true" }, done ? "✓" : String(++number));
    return element("li", { class: done ? "done" : "" }, mark, element("div", {}, element("b", {}, title), hiddenText(done ? "done" : "still to do"), " ", ...words));
  };
  const list = element("ol", { class: "load-steps" });
  const joints = robot === null ? 0 : robot.joints.length;
  list.append(
    robot === null
      ? line(false, "A robot file.", "What is known of the arm: ", element("code", {}, ".toml"), ", or a URDF to make one of. Without either, ", element("code", {}, "offnominal new"), " begins one from a table of lengths and masses.")
      : line(true, "Robot:", `${robot.file}, “${robot.name}”, ${joints} ${joints === 1 ? "joint" : "joints"}`),
  );
  const recordingLine = line(recordings.length > 0, recordings.length > 0 ? "Recordings:" : "A recording.", recordings.length > 0 ? "" : "Time, position and torque or motor current of every joint while the arm moves; several will do. Velocities are welcome.");
  if (recordings.length > 0) recordingLine.lastChild.append(recordingList(recordings));
  list.append(recordingLine);
  const ready = map !== null && map.missing.length === 0;
  list.append(
    line(ready, "What the columns are.", map === null ? "Guessed once both are there, shown, and put right below." : `Told by ${map.from}; look at them below, then use them.`),
  );
  return list;
}

function recordingList(recordings) {
  const list = element("ul", { class: "load-recordings" });
  for (const { id, name, bytes, held_out: heldOut } of recordings) {
    const box = element("input", { type: "checkbox", id: `held-out-${id}` });
    box.checked = heldOut;
    box.addEventListener("change", () => loadActions.holdOut(id, box.checked));
    const remove = button(`remove-${id}`, "Remove", () => loadActions.remove(id));
    remove.append(element("span", { class: "hidden-text" }, ` ${name}`));
    const label = element("label", { for: `held-out-${id}` }, box, " hold out", element("span", { class: "hidden-text" }, ` ${name}`));
    list.append(element("li", {}, element("span", { class: "file-name" }, name), element("span", { class: "soft" }, sizeWords(bytes)), label, remove));
  }
  return list;
}

function loadMessageContent() {
  const content = [];
  if (load.message !== null) {
    for (const words of load.message.split("\n")) content.push(noteWith(load.confirm ? "warn" : "bad", words));
    if (load.confirm) content.at(-1).firstChild.append(" ", button("use-anyway", "Begin anew", () => loadActions.use(true)));
  }
  if (load.written.length > 0) content.push(noteWith("good", `Written: ${load.written.join(", ")}`));
  return content;
}

/** With a session there is more to see than its files. */
function foldLoad(folded) {
  const fold = document.getElementById("load-fold");
  fold.open = !folded;
  fold.toggleAttribute("data-foldable", folded);
}

function showLoad() {
  const { state: given } = load;
  if (places.desk.hidden) {
    const title = given.robot === null ? "Studio" : `Studio: ${given.robot.name}`;
    document.title = given.robot === null ? "offnominal Studio" : title;
    const header = element("header", {}, element("h1", {}, title));
    header.append(element("p", { class: "subtitle" }, "Recordings of a robot and the file of its model: what the model misses, and which effect makes up for it."));
    replaceContent(places.head, header);
  }
  replaceContent(places.loadSteps, stepsContent(given));
  replaceContent(places.loadMessage, ...loadMessageContent());
  const notes = given.robot?.notes ?? [];
  replaceContent(places.loadNotes, notes.length === 0 ? "" : foldedList("robot-notes", `What the URDF's import merged, left out or assumed (${notes.length})`, notes));
  replaceContent(places.loadMap, ...(given.map === null ? [] : mapContent(given)));
  if (load.doing !== "") holdControls(true);
}

function foldedList(id, title, lines) {
  const list = element("ul");
  for (const words of lines) list.append(element("li", {}, words));
  const fold = foldWith(id, title);
  fold.append(list);
  return fold;
}

/** A page that is given its files: where they are dropped stays, folded up once there is a session. */
async function startLoad(host, loaded, onSession) {
  load.onSession = onSession;
  load.state = await ask("GET", "load");
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
