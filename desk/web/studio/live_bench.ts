import { element } from "../report/element";
import { formatNumber, formatSignificant, withUnit } from "../report/format";
import type { Moment } from "./api";
import { complainLive, liveActions } from "./live_actions";
import { sizeFrom } from "./live_size";
import { jointName, live, liveSetup } from "./live_state";
import { button, effectTitle, replaceContent } from "./parts";
import { place, placeOf } from "./places";

function faultOf(kind: string) {
  const fault = liveSetup().faults.find((each) => each.kind === kind);
  if (fault === undefined) throw new Error(`there is no fault ${kind}`);
  return fault;
}

/** What can be done to a simulated run; made once, its words follow the choice. */
export function benchContent() {
  const kind = element("select", { id: "fault-kind" });
  for (const onBus of [false, true]) {
    const label = onBus ? "Bus" : "Arm, drives, encoders";
    const group = element("optgroup", { label });
    for (const fault of liveSetup().faults.filter(({ on_bus }) => on_bus === onBus)) {
      group.append(element("option", { value: fault.kind }, effectTitle(fault.kind)));
    }
    kind.append(group);
  }
  kind.value = "friction_jump";
  const joint = element("select", { id: "fault-joint" });
  liveSetup().joints.forEach((name, at) => joint.append(element("option", { value: String(at + 1) }, `${at + 1}. ${name}`)));
  const size = element("input", { id: "fault-size", type: "number", step: "any", inputmode: "decimal" });
  const unit = element("span", { id: "fault-unit" });
  const words = element("p", { class: "remark", id: "fault-words" });
  const follow = () => {
    const fault = faultOf(kind.value);
    joint.disabled = fault.joint === "none";
    size.disabled = fault.unit === "";
    size.value = String(fault.proposed ?? "");
    unit.textContent = fault.unit === "" || fault.unit === "1" ? "" : fault.unit;
    words.textContent = `${effectTitle(fault.kind)}: ${fault.words}.`;
  };
  kind.addEventListener("change", follow);
  follow();
  const inject = () => {
    const given = size.disabled ? 0 : sizeFrom(size.value, faultOf(kind.value));
    size.setAttribute("aria-invalid", String(typeof given === "string"));
    if (typeof given === "string") return complainLive(given);
    return liveActions.inject(kind.value, joint.disabled ? 0 : Number(joint.value), given);
  };
  const row = element("div", { class: "live-row" });
  row.append(
    element("label", { for: "fault-kind" }, "Fault"),
    kind,
    element("label", { for: "fault-joint" }, "Joint"),
    joint,
    element("label", { for: "fault-size" }, "Size"),
    size,
    unit,
    button("fault-inject", "Inject", inject, { class: "action main", "data-free": "" }),
    button("fault-end", "End all faults", liveActions.endFaults, { "data-free": "" }),
  );
  return [row, words, place("injected")];
}

/** Which fault, where and how much. */
function faultWords({ kind, joint, size, unit }: Pick<Moment["faults"][number], "kind" | "joint" | "size" | "unit">) {
  const where = joint === null ? "" : `, ${jointName(joint)}`;
  const much = size === null ? "" : `, ${withUnit(formatSignificant(size, 4), unit)}`;
  return `${effectTitle(kind)}${where}${much}`;
}

export function showInjected({ faults }: Moment) {
  const words = JSON.stringify(faults);
  if (words === live.written.faults) return;
  live.written.faults = words;
  const { planned } = liveSetup();
  if (faults.length === 0 && planned.length === 0) {
    replaceContent(placeOf("injected"), element("p", { class: "empty" }, "No fault is injected."));
    return;
  }
  const list = element("ul", { class: "parameters" });
  for (const fault of planned) {
    list.append(element("li", {}, `${faultWords(fault)}, of the scenario, from ${formatNumber(fault.begin_s, ".1f")} s after the arm is free to move`));
  }
  for (const fault of faults) {
    list.append(element("li", {}, `${faultWords(fault)}, since ${formatNumber(fault.since_s, ".1f")} s`));
  }
  replaceContent(placeOf("injected"), list);
}

export function accommodationSwitch() {
  const node = element("button", {
    type: "button",
    id: "accommodation",
    class: "live-switch switch",
    role: "switch",
    "aria-checked": "false",
    "aria-labelledby": "accommodation-name",
  });
  node.addEventListener("click", () => liveActions.accommodate(node.getAttribute("aria-checked") !== "true"));
  return element(
    "div",
    { class: "live-row" },
    node,
    element("span", { id: "accommodation-name" }, "Accommodation: the controller compensates for a fault that the monitor has detected"),
  );
}
