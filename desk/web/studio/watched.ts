import { blockElement } from "../report/blocks";
import type { Section } from "../report/document";
import { drawAll } from "../report/drawing";
import { element } from "../report/element";
import { watchTables } from "../report/tables";
import type { Watched } from "./api";
import { forgetFigures } from "./charts";
import { choiceOf } from "./choices";
import { foldWith, noteWith, replaceContent } from "./parts";
import { placeOf } from "./places";
import { ask, wordsOf } from "./server";

/** The sections that the reader has unfolded: another monitor's or run's are too. */
const unfolded = new Set<string>();

/** Of several questions the answer to the last one is shown. */
let asked = 0;

/** What a campaign's monitors saw of the run that is open; nothing waits for it. */
export function showWatched(run: number, monitors: string[]) {
  const [first] = monitors;
  forgetFigures("watched");
  replaceContent(placeOf("watched"), "");
  ++asked;
  if (first !== undefined) void ofMonitor(run, first, monitors);
}

async function ofMonitor(run: number, detector: string, monitors: string[]) {
  const own = ++asked;
  const heading = element("h2", { id: "watched-heading" }, "What the monitor saw");
  const choice =
    monitors.length > 1
      ? [choiceOf("watched-monitor", "Monitor", monitors.map((name) => [name, name]), detector, (name) => void ofMonitor(run, name, monitors))]
      : [];
  const show = (...content: HTMLElement[]) => {
    forgetFigures("watched");
    replaceContent(placeOf("watched"), heading, ...choice, ...content);
  };
  show(element("p", { class: "progress", role: "status" }, "The monitor runs over the run once more …"));
  try {
    const answer = await ask("GET", "/results/watched", { query: { run, detector } });
    if (own !== asked) return;
    show(...watchedContent(answer));
    for (const details of placeOf("watched").querySelectorAll<HTMLDetailsElement>("details[id]")) {
      details.open = unfolded.has(details.id);
    }
  } catch (error) {
    if (own === asked) show(noteWith("bad", wordsOf(error)));
  }
}

function watchedContent({ words, level, sections }: Watched) {
  return [noteWith(level, words), ...sections.map(sectionFold)];
}

/** Its charts are made once somebody looks: of seven joints with two filters there are twenty. */
function sectionFold({ heading, text, blocks }: Section, index: number) {
  const fold = foldWith(`watched-fold-${index}`, heading);
  fold.addEventListener("toggle", () => {
    if (fold.open) unfolded.add(fold.id);
    else unfolded.delete(fold.id);
    if (!fold.open || fold.querySelector(".blocks")) return;
    const host = element("div", { class: "blocks" });
    blocks.forEach((block, at) => host.append(blockElement(block, `watched${index}.${at}`)));
    if (text !== "") fold.append(element("p", {}, text));
    fold.append(host);
    watchTables(host);
    drawAll();
  });
  return fold;
}
