import { say } from "../report/keys";
import type { State } from "./api";
import { stopPlay } from "./arm_play";
import { showWhole, zoomRange } from "./charts";
import { drawCharts } from "./charts_shown";
import { clearCursors } from "./cursor";
import { letGo } from "./drag";
import { complain, complainOf } from "./message";
import { percent } from "./parts";
import { ask } from "./server";
import { currentJoint, errorOf, look, session, takeState, type Looked } from "./session";
import { setBusy, show } from "./show";

/** Runs one change at a time; what fails is said, and nothing else has changed. */
export async function change(work: () => Promise<void>) {
  if (session.busy) return;
  setBusy(true);
  complain("");
  try {
    await work();
  } catch (error) {
    complainOf(error);
  }
  setBusy(false);
  if (session.wish === null) return;
  const chosen = session.wish;
  session.wish = null;
  await choose(chosen);
}

/** Everything of the session as it is: the server makes the charts while the page shows the rest. */
async function showAll() {
  const charts = drawCharts();
  show();
  await charts;
}

/** A change whose answer is the new state. */
export async function changeModel(question: () => Promise<State>) {
  await change(async () => {
    takeState(await question());
    letGo();
    session.saving = { ...session.saving, words: "", confirm: null };
    await showAll();
    const joint = currentJoint();
    say(`Joint ${joint.joint}: error now ${percent(errorOf(joint, "now"))}`);
  });
}

/** The next page over this session begins where this one is; nothing waits for it. */
export function keepLook() {
  const range = zoomRange();
  const body = { ...look, from: range?.from ?? null, to: range?.to ?? null };
  ask("POST", "/look", { body }).catch(complainOf);
}

/** Another joint or recording; while a change is under way the last wish waits for its end. */
export async function choose(what: Partial<Looked>) {
  if (session.busy) {
    session.wish = { ...session.wish, ...what };
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
    await showAll();
    keepLook();
  });
}
