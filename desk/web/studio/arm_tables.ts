import type { Cell, Grid, Value } from "../report/document";
import { itemAt } from "../report/lists";
import type { Arm, ArmJoint } from "./api";

/** What the table of A and B shows of every joint: how it is called, where it is in the answer, its unit. */
export type Quantity = "position" | "measured" | "model" | "error" | "percent";

export const kQuantities: Record<Quantity, { name: string; unit: (joint: ArmJoint) => string }> = {
  position: { name: "Position", unit: ({ unit }) => unit },
  measured: { name: "Measured torque", unit: ({ torque_unit }) => torque_unit },
  model: { name: "Model torque", unit: ({ torque_unit }) => torque_unit },
  error: { name: "Error", unit: ({ torque_unit }) => torque_unit },
  percent: { name: "Error as a share of the torque", unit: () => "%" },
};

export interface Marks {
  a: Arm | null;
  b: Arm | null;
}

/** One unit where all joints have it, or none in the column's head. */
function commonUnit(joints: ArmJoint[], quantity: Quantity): string {
  const [first = "", ...others] = new Set(joints.map(kQuantities[quantity].unit));
  return others.length === 0 ? first : "";
}

function jointTitle(joint: ArmJoint, units: string) {
  return `${joint.joint}. ${joint.name}${units === "" ? "" : ` [${units}]`}`;
}

/** Of the instant that is shown: what the picture shows, in numbers. */
export function cursorTable(data: Arm, instant: number): Grid {
  const { joints } = data;
  const mixed = commonUnit(joints, "position") === "";
  const columns = [
    { name: "Joint", unit: "", format: "" },
    { name: "Position", unit: commonUnit(joints, "position"), format: ".4g" },
    { name: "Error", unit: commonUnit(joints, "error"), format: ".3g" },
    { name: "Share", unit: "%", format: ".1f" },
  ];
  if (data.over_bound !== null) columns.push({ name: "Of bound", unit: "", format: ".2f" });
  const rows = joints.map((joint, index) => {
    const row: Cell[] = [jointTitle(joint, mixed ? `${joint.unit}, ${joint.torque_unit}` : "")];
    for (const what of [data.position, data.error, data.percent]) row.push(what[index]?.[instant] ?? null);
    if (data.over_bound !== null) row.push(data.over_bound[index]?.[instant] ?? null);
    return row;
  });
  return { caption: "At the cursor; share: of the rms of the joint's torque", columns, rows };
}

/** At the cursor, at A and at B; null: there is none. */
type Row = [Value, Value, Value];

/** From A to B. */
export function difference(a: Value, b: Value): Value {
  return a === null || b === null ? null : b - a;
}

/** A, B and what lies between them, of one quantity. */
export function markTable(data: Arm, { a, b }: Marks, instant: number, quantity: Quantity): Grid {
  const unit = commonUnit(data.joints, quantity);
  const times: Row = [itemAt(data.t_s, instant), a?.t_s[0] ?? null, b?.t_s[0] ?? null];
  const columns = [{ name: "Joint", unit: "", format: "" }];
  for (const name of ["Cursor", "A", "B", "B \u2212 A"]) columns.push({ name, unit, format: ".5g" });
  const line = (name: string, [at, atA, atB]: Row): Cell[] => [name, at, atA, atB, difference(atA, atB)];
  const rows = data.joints.map((joint, index) =>
    line(jointTitle(joint, unit === "" ? kQuantities[quantity].unit(joint) : ""), [
      data[quantity][index]?.[instant] ?? null,
      a?.[quantity][index]?.[0] ?? null,
      b?.[quantity][index]?.[0] ?? null,
    ]),
  );
  rows.unshift(line("Time [s]", times));
  return { caption: `${kQuantities[quantity].name} at A and B`, columns, rows };
}
