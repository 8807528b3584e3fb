import { element } from "../report/element";
import type { LoadRecording } from "./api";
import { load, loadChange, showLoad } from "./load";
import { button, foldWith } from "./parts";
import { kPayloadFields, readPayload, textsOf, type PayloadField, type PayloadTexts } from "./payload_fields";
import { refusedNote, type Refused } from "./refusals";
import { ask, wordsOf } from "./server";

/** What somebody has written and the server has not taken: the page around it is made anew meanwhile. */
interface Draft {
  texts: PayloadTexts;
  /** Fields that it was refused for. */
  wrong: PayloadField[];
  refused: Refused | null;
}

const drafts = new Map<number, Draft>();

function draftOf({ id, payload }: LoadRecording): Draft {
  return drafts.get(id) ?? { texts: textsOf(payload), wrong: [], refused: null };
}

function refuse(id: number, texts: PayloadTexts, words: string, wrong: PayloadField[]) {
  drafts.set(id, { texts, wrong, refused: { words, told: false } });
}

async function set({ id }: LoadRecording, texts: PayloadTexts) {
  const read = readPayload(texts);
  if ("words" in read) {
    refuse(id, texts, read.words, read.fields);
    showLoad();
    return;
  }
  await loadChange(async () => {
    try {
      load.state = await ask("POST", "/load/payload", { body: { recording: id, ...read } });
      drafts.delete(id);
    } catch (error) {
      refuse(id, texts, wordsOf(error), kPayloadFields.map(([, field]) => field));
    }
  });
}

function takeAway({ id }: LoadRecording) {
  return loadChange(async () => {
    load.state = await ask("DELETE", "/load/payload/{id}", { path: { id } });
    drafts.delete(id);
    // Its button goes: what it belonged to stays.
    document.getElementById(`payload-${id}-summary`)?.focus();
  });
}

function fieldElement(recording: LoadRecording, label: string, field: PayloadField, unit: string) {
  const { texts, wrong } = draftOf(recording);
  const id = `payload-${recording.id}-${field}`;
  const input = element("input", { type: "text", inputmode: "decimal", autocomplete: "off", id });
  input.value = texts[field];
  input.addEventListener("input", () => {
    const draft = draftOf(recording);
    drafts.set(recording.id, { ...draft, texts: { ...draft.texts, [field]: input.value } });
  });
  if (wrong.includes(field)) {
    input.setAttribute("aria-invalid", "true");
    input.setAttribute("aria-describedby", `payload-${recording.id}-wrong`);
  }
  return element("label", { for: id }, `${label} `, input, ` ${unit}`);
}

/** What the robot carried in a recording: said, put right and taken away again, one click away. */
export function payloadElement(recording: LoadRecording) {
  const { id, name, payload } = recording;
  const fields = element("fieldset", {}, element("legend", {}, `What the robot carried in ${name}, and where in the last link’s frame`));
  for (const [label, field, unit] of kPayloadFields) fields.append(fieldElement(recording, label, field, unit));
  fields.append(element("button", { type: "submit", id: `payload-${id}-set`, class: "action" }, "Set payload"));
  if (payload !== null) fields.append(button(`payload-${id}-remove`, "Take payload away", () => takeAway(recording)));
  const { refused } = draftOf(recording);
  const form = element("form", { novalidate: "" }, fields);
  if (refused !== null) form.append(refusedNote(`payload-${id}-wrong`, refused));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    if (load.doing === "") void set(recording, draftOf(recording).texts);
  });
  const fold = foldWith(`payload-${id}`, `Payload: ${payload === null ? "none" : payload.words}`);
  fold.classList.add("payload");
  fold.append(form);
  return fold;
}
