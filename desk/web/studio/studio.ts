import { byId, element } from "../report/element";
import { follow } from "./actions";
import type { LiveSetup } from "./api";
import { armElement } from "./arm_card";
import { keepLook } from "./changes";
import { showTime, tellOfZoom } from "./charts";
import { drawCharts, drawFiner } from "./charts_shown";
import { letGo } from "./drag";
import { exploreElement, forgetExploredJoints } from "./explore";
import { meaningContent } from "./joints";
import { startLive } from "./live";
import { startLoad } from "./load";
import { complainOf } from "./message";
import { replaceContent, sectionWith } from "./parts";
import { place, placeOf } from "./places";
import { startResults } from "./results";
import { ask, watchLeaving } from "./server";
import { forgetSaving, look, session, state, takeState, worstJoint } from "./session";
import { show } from "./show";
import { tourStart } from "./tour";

function buildStudio() {
  const main = element("main");
  const side = element("div", { class: "side" });
  side.append(place("joints"), sectionWith("effects", "Effects", place("effects")));
  const pictures = element("div", { class: "pictures" });
  pictures.append(
    element("p", { class: "tour-row" }, tourStart()),
    place("headline"),
    place("message", { role: "alert" }),
    sectionWith(
      "look",
      "Measured and model",
      meaningContent(),
      place("recording"),
      armElement(),
      place("charts", { class: "blocks" }),
      exploreElement(),
    ),
    sectionWith("steps", "What was added", place("fall"), place("steps")),
    sectionWith("learn", "What is missing?", place("learn")),
    sectionWith("save", "Save", place("save")),
  );
  const desk = place("desk", { class: "desk" });
  desk.append(place("run", { class: "run" }), place("watched", { class: "run" }), side, pictures);
  main.append(place("head"), place("live"), place("load"), place("results"), desk);
  const footer = element("footer");
  footer.append(
    element("p", { id: "spoken", class: "hidden-text", role: "status" }),
    element("p", {}, "offnominal Studio, diagnostic aid, claims no SIL/PL. Nothing leaves this machine."),
    element(
      "p",
      { class: "chart-help" },
      "Charts: drag to zoom, shift-drag to move, ctrl-wheel to zoom, double click to reset. A chart that " +
        "has the focus takes keys: arrows show values, + and - zoom, 0 resets. The arm: drag to turn, ctrl-wheel to come nearer. " +
        "Drawn with Apache ECharts and three.js.",
    ),
  );
  byId("page").append(main, footer);
}

/** What the session holds now: at the start, and when a live view hands a stretch over to it. */
async function loadSession() {
  takeState(await ask("GET", "/state"));
  session.found = await ask("GET", "/explanation");
  placeOf("desk").hidden = false;
  letGo();
  forgetExploredJoints();
  Object.assign(look, { joint: worstJoint(state().joints), recording: 1, beside: null });
  const kept = state().look;
  if (kept !== null) Object.assign(look, { joint: kept.joint, recording: kept.recording, beside: kept.beside });
  forgetSaving();
  show();
  await drawCharts();
  if (kept !== null && kept.from !== null && kept.to !== null) showTime({ from: kept.from, to: kept.to });
  if (session.found.state === "running") void follow();
}

/** Before a live view has handed anything over there is nothing to analyse. */
function showUnloaded({ robot }: LiveSetup) {
  document.title = `Studio: ${robot.name}`;
  placeOf("desk").hidden = true;
  const header = element("header", {}, element("h1", {}, `Studio: ${robot.name}`));
  header.append(element("p", { class: "subtitle" }, `${robot.file} · no recording is loaded; “Explain this” at a detection loads one`));
  replaceContent(placeOf("head"), header);
}

export async function start() {
  buildStudio();
  watchLeaving();
  tellOfZoom((range) => {
    keepLook();
    drawFiner(range).catch(complainOf);
  });
  try {
    const setup = await ask("GET", "/live");
    placeOf("desk").hidden = !setup.loaded;
    if (setup.takes_files) {
      await startLoad(placeOf("load"), setup.loaded, async () => {
        await loadSession();
        placeOf("head").scrollIntoView({ block: "start" });
      });
    } else if (setup.has_results) {
      await startResults(placeOf("results"), async () => {
        await loadSession();
        placeOf("desk").scrollIntoView({ block: "start" });
      });
    } else if (!setup.loaded && setup.source !== null) showUnloaded(setup);
    if (setup.source !== null) {
      startLive(setup, placeOf("live"), async (isOwn) => {
        await loadSession();
        // Who watches another page's analysis come is left where they are.
        if (isOwn) byId("learn").scrollIntoView({ block: "start" });
      });
    }
    if (setup.loaded) await loadSession();
  } catch (error) {
    placeOf("desk").hidden = false;
    complainOf(error);
  }
}
