import { shareExtents } from "../report/drawing";
import { element } from "../report/element";
import { figures } from "../report/figure";
import type { Figure } from "../report/figure_type";
import type { QueryTo, Step } from "./api";
import { drawn, makeFigure } from "./charts";
import { drawSoon, forgetDrawing } from "./draw_soon";
import { foldWith } from "./parts";
import { ask, wordsOf } from "./server";

/**
 * Pictures of what effects do, by what they are of: {host, place, figure}. They outlive the cards, which are made anew
 * with every answer.
 */
const evidence = new Map<string, Picture>();

interface Picture {
  host: HTMLElement;
  place: string;
  figure: Figure | null;
}

type Asked = QueryTo<"GET", "/evidence">;

let evidenceCount = 0;

/**
 * What the error looks like without an effect, and the effect's torque over it: asked for once.
 * `key`: which effect of which model; `query`: how the server calls it.
 */
export function evidenceElement(key: string, query: Asked) {
  const known = evidence.get(key);
  if (known) return known.host;
  const host = element("div", { class: "evidence" }, element("p", { class: "remark" }, "Drawing its picture …"));
  const picture: Picture = { host, place: `evidence.${++evidenceCount}`, figure: null };
  evidence.set(key, picture);
  evidenceQueue = evidenceQueue.then(() => drawEvidence(picture, query));
  return host;
}

/** One after the other: each takes the server some time. */
let evidenceQueue: Promise<void> = Promise.resolve();

async function drawEvidence(picture: Picture, query: Asked) {
  if (!picture.host.isConnected) return forgetUnseen();
  try {
    const { chart } = await ask("GET", "/evidence", { query });
    if (!picture.host.isConnected) return forgetUnseen();
    picture.host.replaceChildren();
    picture.figure = makeFigure(chart, picture.place, picture.host);
    shareExtents();
    drawSoon([picture.figure]);
  } catch (error) {
    picture.host.replaceChildren(element("p", { class: "remark" }, wordsOf(error)));
  }
}

/** Pictures of cards that are gone. */
export function forgetUnseen() {
  for (const [key, { host, place, figure }] of evidence) {
    if (host.isConnected) continue;
    evidence.delete(key);
    drawn.delete(place);
    if (figure === null) continue;
    forgetDrawing(figure);
    figure.chart?.dispose();
    figures.splice(figures.indexOf(figure), 1);
  }
}

/** The picture of a step, unfolded by the reader: it follows the model. */
export function stepEvidence(step: Step, revision: number) {
  const id = `evidence-of-step-${step.id}`;
  const details = foldWith(id, "What the error looks like without it");
  const key = `step ${step.id} ${revision}`;
  const fill = () => details.append(evidenceElement(key, { step: step.id }));
  if (evidence.has(key)) fill();
  details.addEventListener("toggle", () => {
    if (details.open && !details.querySelector(".evidence")) fill();
  });
  return details;
}
