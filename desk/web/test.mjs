// Runs the tests of the modules with node's own runner:
//   node test.mjs OUT        they are bundled into the folder OUT
import { spawnSync } from "node:child_process";
import { readdirSync, rmSync } from "node:fs";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const out = process.argv[2];
if (out === undefined) {
  console.error("node test.mjs OUT");
  process.exit(2);
}
// What was a test once is none any more.
rmSync(resolve(out), { recursive: true, force: true });
const build = fileURLToPath(new URL("build.mjs", import.meta.url));
const bundled = spawnSync(process.execPath, [build, resolve(out), "--tests"], { stdio: "inherit" });
if (bundled.status !== 0) process.exit(2);
const tests = readdirSync(resolve(out)).filter((name) => name.endsWith(".test.mjs"));
if (tests.length === 0) {
  console.error(`no tests in ${out}`);
  process.exit(2);
}
const { status } = spawnSync(process.execPath, ["--test", ...tests.map((name) => join(resolve(out), name))], { stdio: "inherit" });
process.exit(status ?? 2);
