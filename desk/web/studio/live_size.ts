import { withUnit } from "../report/format";
import type { LiveSetup } from "./api";

type FaultChoice = LiveSetup["faults"][number];

/** Of what stands in the field, whose text is empty where it is no number: the size, or why it is none. */
export function sizeFrom(text: string, { least, most, unit }: Pick<FaultChoice, "least" | "most" | "unit">): number | string {
  const size = Number(text);
  if (text.trim() !== "" && Number.isFinite(size) && size !== 0) return size;
  const what = size === 0 && text.trim() !== "" ? "A size of 0 is no fault" : "The size is no number";
  return `${what}: it has to be ${least} to ${withUnit(String(most), unit)}, and not 0. Nothing was injected.`;
}
