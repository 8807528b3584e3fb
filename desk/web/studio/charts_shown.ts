import type { AnswerTo, Errors, QueryTo } from "./api";
import { drawArm } from "./arm";
import { chartQuery, showCharts, showFiner, zoomRange } from "./charts";
import { dragging, followDrag, type Dragged } from "./drag";
import { drawExplored } from "./explore";
import { headlineContent, showDraggedJoint } from "./joints";
import { complainOf } from "./message";
import { replaceContent } from "./parts";
import { placeOf } from "./places";
import { ask } from "./server";
import { look, state } from "./session";
import type { TimeRange } from "./time_range";

/** Of several questions about the charts the answer to the last one is shown. */
let chartsAsked = 0;

async function lastAnswer<Answer extends { revision: number }>(question: Promise<Answer>): Promise<Answer | null> {
  const own = ++chartsAsked;
  const answer = await question;
  if (own !== chartsAsked) return null;
  document.body.dataset.revision = String(answer.revision);
  return answer;
}

function askForCharts(query: QueryTo<"GET", "/charts">): Promise<AnswerTo<"GET", "/charts"> | null> {
  return lastAnswer(ask("GET", "/charts", { query }));
}

/** Charts, arm, map and spectrum of what is looked at. */
export async function drawCharts() {
  const range = zoomRange();
  const answer = await askForCharts(chartQuery(look, range));
  if (answer === null) return;
  showCharts(answer, placeOf("charts"), placeOf("fall"));
  showArm(range);
  explore(range);
}

/** What a zoom changes; null: all of the time is shown. */
export async function drawFiner(range: TimeRange | null) {
  showArm(range);
  explore(range);
  if (dragging.isOff && dragging.last !== null) return drag(dragging.last);
  const answer = await askForCharts(chartQuery(look, range));
  if (answer !== null) showFiner(answer);
}

/** Nothing waits for map and spectrum either. */
export function explore(range: TimeRange | null) {
  drawExplored(look, range).catch(complainOf);
}

/** Nothing waits for the arm. */
function showArm(range: TimeRange | null) {
  drawArm(range).catch(complainOf);
}

/** Wherever the error of the joint stands: that of a model off its fit; null: of the model as it is. */
export function showDragged(dragged: Errors | null) {
  replaceContent(placeOf("headline"), headlineContent(dragged));
  showDraggedJoint(dragged);
}

/** Charts and errors follow a number that is dragged. */
export function drag(number: Dragged): Promise<void> {
  return followDrag(number, drawDragged).catch(complainOf);
}

/** Charts and errors with a number off its fit: no model, and nothing of it stays. */
async function drawDragged(number: Dragged) {
  const query = { ...chartQuery(look, zoomRange()), ...number };
  const answer = await lastAnswer(ask("GET", "/moved", { query }));
  if (answer === null || !dragging.isOff || answer.revision !== state().revision) return;
  const { fitted_percent, held_out_percent } = answer;
  showDragged({ fitted_percent, held_out_percent });
  showFiner(answer);
}
