import type { Signal, SignalEdit } from "./api";
import type { Choice } from "./choices";

type SignalName = { quantity: Signal["quantity"]; joint: number | null };

export type Change = Omit<SignalEdit, "quantity" | "joint">;

export function signalWords({ quantity, joint }: SignalName): string {
  return joint === null ? "the time" : `the ${quantity} of joint ${joint}`;
}

export function editOf(signal: SignalName, change: Change): SignalEdit {
  return { quantity: signal.quantity, ...(signal.joint === null ? {} : { joint: signal.joint }), ...change };
}

export function columnOptions(signal: Signal, columns: string[]): Choice[] {
  const options = columns.map((name): Choice => [name, name]);
  if (signal.quantity === "velocity") options.unshift(["", "derived"]);
  else if (signal.source === "") options.unshift(["", signal.more === "" ? "choose a column" : signal.more]);
  if (signal.source !== "" && !columns.includes(signal.source)) options.push([signal.source, `${signal.source} (not there)`]);
  return options;
}
