import type { Signal, SignalEdit } from "./api";
import type { Choice } from "./choices";

type SignalName = Pick<Signal, "quantity" | "joint"> & Partial<Pick<Signal, "file">>;

export type Change = Omit<SignalEdit, "quantity" | "joint" | "file">;

/** "the time of file 2": the first file's is the recording's. */
export function signalWords({ quantity, joint, file = null }: SignalName): string {
  if (joint !== null) return `the ${quantity} of joint ${joint}`;
  return file === null || file === 1 ? "the time" : `the time of file ${file}`;
}

export function editOf({ quantity, joint, file = null }: SignalName, change: Change): SignalEdit {
  return { quantity, ...(joint === null ? {} : { joint }), ...(file === null ? {} : { file }), ...change };
}

export function columnOptions(signal: Signal, columns: string[]): Choice[] {
  const options = columns.map((name): Choice => [name, name]);
  if (signal.quantity === "velocity") options.unshift(["", "derived"]);
  else if (signal.source === "") options.unshift(["", signal.more === "" ? "choose a column" : signal.more]);
  if (signal.source !== "" && !columns.includes(signal.source)) options.push([signal.source, `${signal.source} (not there)`]);
  return options;
}
