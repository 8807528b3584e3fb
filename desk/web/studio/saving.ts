import { element } from "../report/element";
import { say } from "../report/keys";
import type { State } from "./api";
import { change } from "./changes";
import { addToNote, button, holdControls, noteWith, replaceContent } from "./parts";
import { placeOf } from "./places";
import { ask, mayConfirm, wordsOf } from "./server";
import { nextConfirm, session, state, takeState, type Agreed } from "./session";

/** What is under "save" now. */
export function showSave() {
  replaceContent(placeOf("save"), ...saveContent());
  if (session.busy) holdControls(true);
}

function saveContent(): HTMLElement[] {
  const { save, steps } = state();
  if (steps.length === 0) {
    return [element("p", { class: "empty" }, "There is nothing to save yet: switch an effect on first.")];
  }
  const name = nameInput(save);
  const form = element("div", { class: "save-row" });
  form.append(
    element("label", { for: "save-name" }, save.fixed ? "Robot file" : "Robot file, beside the one that was read"),
    name,
    button("save-file", "Save", () => change(() => saveRobot({})), { class: "action main" }),
    button("save-page", "Save a page for others", () => change(() => savePage({}))),
  );
  return [form, ...outcomeContent(), ...commandsContent(save)];
}

function nameInput(save: State["save"]): HTMLInputElement {
  const name = element("input", { type: "text", id: "save-name", spellcheck: "false", autocomplete: "off" });
  name.value = session.saving.name ?? save.name;
  name.readOnly = save.fixed;
  name.addEventListener("input", () => {
    session.saving = { ...session.saving, name: name.value, confirm: null, words: "" };
    placeOf("save").querySelector(".note")?.remove();
  });
  return name;
}

/** What came of the last one, and what a second one would do. */
function outcomeContent(): HTMLElement[] {
  const { words, level, confirm } = session.saving;
  if (words === "") return [];
  const note = noteWith(level, words, " ");
  if (confirm !== null) addToNote(note, button("save-anyway", "Save all the same", confirm));
  return [note];
}

function commandsContent({ commands, commands_note: note }: State["save"]): HTMLElement[] {
  if (commands.length === 0) {
    const why = "The robot file that was read is replaced: no command can start from it any more.";
    return [element("p", { class: "remark" }, why)];
  }
  const copy = () => void navigator.clipboard.writeText(commands.join("\n"));
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

/** The name to write under, as a request says it: not where it is fixed. */
function named(): { name?: string } {
  const { save } = state();
  return save.fixed ? {} : { name: session.saving.name ?? save.name };
}

async function saveRobot(agreed: Agreed) {
  const name = named();
  await tellOutcome(
    async () => {
      const { saved, commands } = await ask("POST", "/save", { body: { ...name, ...agreed } });
      takeState({ ...state(), save: { ...state().save, ...name, saved, commands } });
      return saved;
    },
    () => saveRobot(nextConfirm(state(), agreed)),
  );
}

/** The report page of `compare`, for those who have no Studio. */
async function savePage(agreed: Agreed) {
  await tellOutcome(
    async () => (await ask("POST", "/page", { body: { ...named(), ...agreed } })).saved,
    () => savePage({ replace: true }),
  );
}

/** `write` gives what it has written; `again`: the same where the reader agrees to what it was refused for. */
async function tellOutcome(write: () => Promise<string>, again: () => Promise<void>) {
  try {
    const words = `Written: ${await write()}`;
    session.saving = { ...session.saving, words, level: "good", confirm: null };
  } catch (error) {
    const confirm = mayConfirm(error) ? () => void change(again) : null;
    const level = mayConfirm(error) ? "warn" : "bad";
    session.saving = { ...session.saving, words: wordsOf(error), level, confirm };
  }
  showSave();
  say(session.saving.words);
}

