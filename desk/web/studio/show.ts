import { byId } from "../report/element";
import { actions } from "./actions";
import { zoomRange } from "./charts";
import { explore } from "./charts_shown";
import { forgetUnseen } from "./evidence";
import { showExploreChoices } from "./explore";
import { headerContent, headlineContent, jointChoice, recordingPicker } from "./joints";
import { learnContent, updateProgress } from "./learn";
import { addToNote, baseName, button, holdControls, noteWith, replaceContent } from "./parts";
import { placeOf } from "./places";
import { remarkNotes } from "./remarks";
import { hasResults } from "./results";
import { showSave } from "./saving";
import { currentJoint, session, state } from "./session";
import { effectList, stepList } from "./steps";
import { updateTour } from "./tour";

/** All but the charts. */
export function show() {
  const joint = currentJoint();
  const { robot, recordings, hints, joints, steps } = state();
  if (!hasResults()) document.title = `Studio: ${robot.name}`;
  const host = placeOf(hasResults() ? "run" : "head");
  replaceContent(host, headerContent(), ...hints.map((hint) => noteWith("warn", hint)), ...remarkNotes(recordings));
  replaceContent(placeOf("joints"), jointChoice());
  replaceContent(placeOf("headline"), headlineContent());
  byId("effects-heading").textContent = `Effects of joint ${joint.joint}`;
  replaceContent(placeOf("effects"), ...effectList(joint, actions));
  replaceContent(placeOf("recording"), recordingPicker());
  showExploreChoices(joints, joint.unit === "N", () => explore(zoomRange()));
  replaceContent(placeOf("steps"), ...keptContent(), stepList(state(), actions));
  placeOf("fall").hidden = steps.length === 0;
  showFound();
  showSave();
}

/** The search for what is missing, as it is now. */
export function showFound() {
  const { found } = session;
  if (found.state !== "running" || !updateProgress(found)) {
    replaceContent(placeOf("learn"), ...learnContent(found, state(), actions));
    if (session.busy) holdControls(true);
  }
  document.body.toggleAttribute("data-searching", found.state === "running");
  updateTour();
  forgetUnseen();
}

export function setBusy(value: boolean) {
  session.busy = value;
  document.body.toggleAttribute("data-busy", value);
  placeOf("effects").setAttribute("aria-busy", String(value));
  holdControls(value);
}

/** Where the session is kept, and what was taken up of one before. */
function keptContent(): HTMLElement[] {
  const { steps, kept } = state();
  const { file, problem, taken_up: count, not_taken_up: why } = kept;
  const content = [];
  if (count > 0 && steps.length > 0) {
    const what = count === 1 ? "One step was" : `${count} steps were`;
    const note = noteWith("neutral", `${what} added in a session before, and taken up from ${baseName(file)}. `);
    addToNote(note, button("begin-anew", "Begin anew", actions.undoAll));
    content.push(note);
  }
  if (why !== "") content.push(noteWith("warn", `Not all of the session before could be taken up: ${why}.`));
  if (problem !== "") content.push(noteWith("warn", `What is done here is not kept: ${problem}`));
  return content;
}
