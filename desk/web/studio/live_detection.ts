import { followWindow, redraw, shareExtents } from "../report/drawing";
import { element, within, type Attributes } from "../report/element";
import { figureWith } from "../report/figure";
import { formatNumber } from "../report/format";
import { say } from "../report/keys";
import { itemAt } from "../report/lists";
import type { Detection, Moment } from "./api";
import { complainLive, liveActions } from "./live_actions";
import { jointName, live, liveSetup } from "./live_state";
import { button, noteWith, replaceContent } from "./parts";
import { placeOf } from "./places";
import { refill } from "./refill";
import { ask } from "./server";

function detectionWords(detection: Detection) {
  const who = detection.joint === null ? "" : `: ${jointName(detection.joint)}`;
  return `Off nominal since ${formatNumber(detection.t_s, ".2f")} s${who}.`;
}

/** Of a robot with two levels. */
function actWords({ act_t_s, act_joint }: Detection) {
  if (!liveSetup().has_two_levels) return "";
  if (act_t_s === null) return " Not beyond the level to act.";
  const who = act_joint === null ? "" : `: ${jointName(act_joint)}`;
  return ` Beyond the level to act since ${formatNumber(act_t_s, ".2f")} s${who}.`;
}

const kTorqueSpaceWords =
  'With space = "torque" and isolation = true in [estimator] of the robot file the monitor says which joint it is, and which kind of fault.';

function answerWords({ answer, joint }: Detection) {
  if (answer === null) {
    if (joint !== null) return " Which fault it is will be said in a moment.";
    // All joints are judged together there, and nothing else will come.
    return liveSetup().space === "acceleration" ? ` ${kTorqueSpaceWords}` : "";
  }
  return ` ${answer.words}${answer.decided ? "" : " (so far)"}.`;
}

function detectionContent({ detection, ended }: Moment) {
  if (detection === null) {
    const words = liveSetup().has_bound
      ? "Nothing was detected yet. A detection keeps what was around it for a look."
      : "Without a bound nothing is detected.";
    return [element("p", { class: "empty" }, ended === "" ? words : ended)];
  }
  const note = noteWith("bad", element("b", {}, detectionWords(detection)), actWords(detection), answerWords(detection));
  const controls = element("div", { class: "live-row" });
  const waits: Attributes = detection.frozen ? {} : { "aria-disabled": "true" };
  controls.append(
    button("live-explain", "Explain this", liveActions.explain, { class: "action main", "data-free": "", ...waits }),
  );
  const words = detection.frozen
    ? `The analysis gets what came since the detection, up to ${liveSetup().explained_s[1]} s: the more of it moves, the more it can tell.`
    : "What follows is still awaited …";
  return [note, controls, element("p", { class: "remark" }, words)];
}

/** Drawn anew only where it says something else. */
export function showDetection(now: Moment) {
  const words = JSON.stringify([now.detection, now.ended]);
  if (words === live.written.detection) return;
  live.written.detection = words;
  replaceContent(placeOf("detection"), ...detectionContent(now));
  const { detection } = now;
  document.body.dataset.detection = detection === null ? "" : String(detection.number);
  if (detection === null) {
    hideFrozen();
    return;
  }
  if (detection.number !== live.told) {
    live.told = detection.number;
    say(detectionWords(detection));
  }
  if (detection.frozen && detection.number !== live.shown) {
    live.shown = detection.number;
    showFrozen().catch(complainLive);
  }
}

function hideFrozen() {
  live.shown = 0;
  within(document, "#live-frozen").hidden = true;
}

/** What was around the detection, in charts that can be looked at. */
async function showFrozen() {
  const pixels = Math.min(8000, Math.max(100, placeOf("livePicture").clientWidth));
  const { charts } = await ask("GET", "/live/frozen", { query: { pixels } });
  within(document, "#live-frozen").hidden = false;
  if (live.frozen.length === 0) {
    charts.forEach((block, at) => {
      const { root, figure } = figureWith(block, `frozen.${at}`);
      placeOf("frozen").append(root);
      live.frozen.push(figure);
    });
  } else {
    charts.forEach((block, at) => refill(itemAt(live.frozen, at), block));
  }
  shareExtents();
  // While it was hidden the window may have become another.
  live.frozen.forEach(redraw);
  followWindow();
}
