import { say } from "../report/keys";
import type { Effect } from "./api";
import { change, changeModel, keepLook } from "./changes";
import { drag, drawCharts, showDragged } from "./charts_shown";
import { dragging, letGo } from "./drag";
import { complainOf } from "./message";
import { ask } from "./server";
import { look, session } from "./session";
import { showFound } from "./show";

/** What the reader can do with the model; a list or a card is given them all. */
export type Actions = typeof actions;

export const actions = {
  add: (effect: string, joint: number) => {
    if (!session.busy) look.joint = joint;
    return changeModel(() => ask("POST", "/steps", { body: { effect, joint } })).then(keepLook);
  },
  drag,
  snapBack: () => {
    if (!dragging.isOff) return;
    letGo();
    showDragged(null);
    drawCharts().catch(complainOf);
  },
  undoAll: () => changeModel(() => ask("DELETE", "/steps")),
  undo: (id: number) => changeModel(() => ask("DELETE", "/steps/{id}", { path: { id } })),
  toggle: (effect: Effect, joint: number) => {
    const last = effect.steps.at(-1);
    return last === undefined ? actions.add(effect.effect, joint) : actions.undo(last);
  },
  search: () =>
    change(async () => {
      session.found = await ask("POST", "/explanation");
      showFound();
      void follow();
    }),
  stop: async () => {
    await ask("DELETE", "/explanation").catch(complainOf);
  },
};

/** As long as the search runs: how far it is, and in the end what it found. */
export async function follow() {
  while (session.found.state === "running") {
    await new Promise((done) => setTimeout(done, 400));
    try {
      session.found = await ask("GET", "/explanation");
    } catch (error) {
      complainOf(error);
      return;
    }
    showFound();
  }
  const { answer } = session.found;
  say(session.found.state === "done" && answer !== null ? answer.words : "The search has ended.");
}
