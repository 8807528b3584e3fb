import { say } from "../report/keys";
import { live } from "./live_state";
import { noteWith, replaceContent } from "./parts";
import { placeOf } from "./places";
import { ask, wordsOf } from "./server";

export function complainLive(error: unknown) {
  const words = wordsOf(error);
  if (words === live.written.complaint) return;
  live.written.complaint = words;
  replaceContent(placeOf("liveMessage"), words === "" ? "" : noteWith("bad", words));
}

async function act(work: () => Promise<unknown>) {
  complainLive("");
  try {
    await work();
  } catch (error) {
    complainLive(error);
  }
}

export const liveActions = {
  inject: (kind: string, joint: number, size: number) =>
    act(() => ask("POST", "/live/faults", { body: { kind, joint, size } })),
  endFaults: () => act(() => ask("DELETE", "/live/faults")),
  accommodate: (on: boolean) => act(() => ask("POST", "/live/accommodation", { body: { on } })),
  again: () => act(() => ask("POST", "/live/again")),
  startRecording: () =>
    act(async () => {
      live.saved = "";
      await ask("POST", "/live/recording");
    }),
  stopRecording: () =>
    act(async () => {
      const { saved } = await ask("DELETE", "/live/recording");
      live.saved = `Written: ${saved}`;
      say(live.saved);
    }),
  explain: () =>
    act(async () => {
      say("The stretch is handed to the analysis.");
      const shown = live.session;
      live.session = null; // until the answer says which, the moments that come meanwhile do not load it
      try {
        const { saved, before, session } = await ask("POST", "/live/explanation");
        live.saved = `Written: ${saved}, and of before the detection ${before}`;
        live.session = session;
      } catch (error) {
        live.session = shown;
        throw error;
      }
      await live.onLoaded(true);
    }),
};
