import { element } from "../report/element";
import type { LoadRecording } from "./api";
import { choiceOf, type Choice } from "./choices";
import { sizeWords } from "./files";
import { load, loadChange, loadState } from "./load";
import { button, foldWith } from "./parts";
import { ask } from "./server";

/** Of which other recording somebody has chosen a recording to be further files, before that is asked for. */
const chosen = new Map<number, number>();

/** The control that was used goes with the recording that it was of: what it belongs to now has the focus. */
function focusFiles(id: number) {
  document.getElementById(`files-${id}-summary`)?.focus();
}

function join(recording: number, to: number) {
  return loadChange(async () => {
    load.state = await ask("POST", "/load/join", { body: { recording, to } });
    chosen.delete(recording);
    focusFiles(to);
  });
}

function split(recording: number) {
  return loadChange(async () => {
    load.state = await ask("POST", "/load/split", { body: { recording } });
    focusFiles(recording);
  });
}

function joinControls({ id, name }: LoadRecording, others: LoadRecording[]) {
  const choices = others.map((other): Choice => [String(other.id), other.name]);
  const known = others.some((other) => other.id === chosen.get(id));
  const to = known ? (chosen.get(id) ?? 0) : (others[0]?.id ?? 0);
  const pick = choiceOf(`join-${id}-to`, "One recording with", choices, String(to), (value) => chosen.set(id, Number(value)));
  const act = button(`join-${id}`, "Join them", () => join(id, chosen.get(id) ?? to));
  act.append(element("span", { class: "hidden-text" }, `: ${name} behind the recording that is chosen`));
  return element("div", { class: "choice-row" }, pick, act);
}

/** "Files: one" */
function filesWords({ files }: LoadRecording): string {
  return files.length === 1 ? "Files: one" : `Files: ${files.length}, one recording`;
}

/** Which files are one recording: seen, said, and taken back, one click away; null: there is nothing to say. */
export function filesElement(recording: LoadRecording) {
  const { id, name, files } = recording;
  const others = loadState().recordings.filter((other) => other.id !== id);
  if (files.length === 1 && others.length === 0) return null;
  const fold = foldWith(`files-${id}`, filesWords(recording));
  fold.classList.add("recording-files");
  if (files.length > 1) {
    const list = element("ol", { class: "joined-files" });
    for (const file of files) list.append(element("li", {}, element("span", { class: "file-name" }, file.name), " ", element("span", { class: "soft" }, sizeWords(file.bytes))));
    const words = "The samples of the first file stay; columns of the others are put there by straight lines between theirs, as far as every file’s time reaches.";
    const apart = button(`split-${id}`, "Take apart", () => split(id));
    apart.append(element("span", { class: "hidden-text" }, ` ${name}`));
    fold.append(list, element("p", { class: "soft" }, words), apart);
  }
  if (others.length > 0) fold.append(joinControls(recording, others));
  return fold;
}
