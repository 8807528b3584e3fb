import type { Cell } from "../report/document";
import { element } from "../report/element";
import { formatNumber } from "../report/format";
import { itemAt } from "../report/lists";
import { scrollingTable } from "../report/tables";
import type { Moment } from "./api";
import { live, liveSetup } from "./live_state";
import { noteWith } from "./parts";

export function liveHeading() {
  const { robot, source, bus, plant } = liveSetup();
  if (source !== "sil") return `Live: ${robot.name} on ${bus}`;
  return `Live: simulated run of ${robot.name}${plant === null ? "" : `, its plant ${plant}`}`;
}

function controllerWords({ controller, ended }: Moment) {
  if (controller === null) return "says nothing of itself on this bus";
  // Where the run has ended by it, what it means stands there.
  if (controller.fault !== null && ended !== "") return `${controller.state}: ${controller.fault}`;
  if (controller.fault !== null) return `${controller.state}: ${controller.fault}, ${controller.fault_words}`;
  return controller.slows ? `${controller.state}, its motion slowed` : controller.state;
}

function monitorWords(now: Moment) {
  if (now.ended !== "") return now.ended;
  if (now.words !== "") return now.words;
  if (!now.driven) return "The drives give no torque: nothing is judged.";
  if (!now.judging) return "settling";
  return now.beyond.some((each) => each) ? "beyond its threshold" : "watching";
}

export function statusContent(now: Moment) {
  const list = element("dl", { class: "live-status" });
  const add = (term: string, words: string) => list.append(element("div", {}, element("dt", {}, term), element("dd", {}, words)));
  add("Controller", controllerWords(now));
  add("Monitor", monitorWords(now));
  add("Time", `${formatNumber(now.t_s, ".1f")} s`);
  add("Pictures a second", String(picturesASecond()));
  const { missing, refused, lost, rejected, overflow } = now.counts;
  add("Samples missing, refused", `${missing}, ${refused}`);
  add("Frames lost, rejected", `${lost}, ${rejected}`);
  if (overflow > 0) add("Frames that this computer was too slow for", String(overflow));
  return list;
}

function picturesASecond() {
  const since = performance.now() - 1000;
  live.pictures = live.pictures.filter((at) => at >= since);
  return live.pictures.length;
}

/** Of what is judged by itself, a row each. */
function liveRows(now: Moment): Cell[][] {
  return liveSetup().judged.map(({ name, unit }, at) => {
    const [residual, threshold] = [now.residual[at] ?? null, now.threshold[at] ?? null];
    const ratio = residual === null || threshold === null ? null : residual / threshold;
    const act = liveSetup().has_two_levels ? [now.act[at] ?? null] : [];
    return [name, unit, residual, threshold, ...act, ratio, now.beyond[at] ? "beyond" : ""];
  });
}

/** Made once: a table that is read keeps its place and its focus. */
export function liveTable(now: Moment) {
  const columns = [
    { name: "judged", unit: "", format: "" },
    { name: "unit", unit: "", format: "" },
    { name: "residual", unit: "", format: ".3g" },
    { name: "threshold", unit: "", format: ".3g" },
    ...(liveSetup().has_two_levels ? [{ name: "level to act", unit: "", format: ".3g" }] : []),
    { name: "residual / threshold", unit: "1", format: ".2f" },
    { name: "now", unit: "", format: "" },
  ];
  const rows = liveRows(now);
  const table = scrollingTable({ caption: "Residual and threshold now", columns, rows });
  live.fillTable = (then) => {
    const lines = table.querySelectorAll("tbody tr");
    liveRows(then).forEach((row, at) => {
      row.forEach((value, of) => {
        const words = typeof value === "string" ? value : formatNumber(value, itemAt(columns, of).format);
        const cell = lines[at]?.children[of];
        if (cell) cell.textContent = words;
      });
    });
  };
  return table;
}

export function boundContent() {
  if (liveSetup().has_bound) return [];
  return [
    noteWith(
      "warn",
      `${liveSetup().robot.file} has no [uncertainty_bound]: the residual is shown without a threshold, and nothing is detected. `,
      "Record the healthy robot, then let ",
      element("code", {}, "offnominal calibrate"),
      " find the bound.",
    ),
  ];
}
