import { formatSignificant } from "../report/format";
import { itemAt } from "../report/lists";

const kRobotKinds = [".toml", ".urdf"];

export function isRobotFile(name: string) {
  return kRobotKinds.some((kind) => name.toLowerCase().endsWith(kind));
}

/** "1 joint", "7 joints". */
export function jointsWords(count: number): string {
  return `${count} ${count === 1 ? "joint" : "joints"}`;
}

export function sizeWords(bytes: number): string {
  const units = ["bytes", "KiB", "MiB", "GiB"];
  const power = Math.floor(Math.log2(Math.max(bytes, 1)) / 10);
  const at = Math.min(power, units.length - 1);
  return `${formatSignificant(bytes / 1024 ** at, 3)} ${itemAt(units, at)}`;
}
