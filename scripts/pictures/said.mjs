// What programs say.
import { spawnSync } from "node:child_process";

/** The standard output of a command that has to succeed. */
export function said(command, args) {
  const run = spawnSync(command, args, { encoding: "utf8", maxBuffer: 1 << 28 });
  if (run.error || run.status !== 0) throw new Error(`${command} ${args.join(" ")}: ${run.error ?? run.stderr}`);
  return run.stdout;
}
