// Draws the pictures of docs/diagnosis.md, each from what the programs have written:
//   node scripts/pictures/diagnosis.mjs [--walk FOLDER] [--delays RESULTS] [--names RESULTS]
//                                       [--offnominal COMMAND] [-o FOLDER]
// --walk: the folder of "The whole way, on seven joints", build/seven, with what its commands made there.
// --delays: results of campaigns/seven_joints.toml; --names: of campaigns/which_fault.toml (SQLite).
// What is not given is not drawn. COMMAND: build/release/apps/command/offnominal, FOLDER: docs/images.
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { drawDelays, drawNames } from "./campaign.mjs";
import { drawFriction, drawResiduals, readWalk } from "./walk.mjs";

const project = fileURLToPath(new URL("../..", import.meta.url));
const text = { type: "string" };
const { values } = parseArgs({
  options: { offnominal: text, walk: text, delays: text, names: text, output: { ...text, short: "o" } },
});
const folder = values.output ?? join(project, "docs/images");
const offnominal = values.offnominal ?? join(project, "build/release/apps/command/offnominal");
if (values.walk) {
  const walk = readWalk(values.walk, offnominal);
  drawResiduals(walk, join(folder, "seven-joints-residuals.svg"));
  drawFriction(walk, join(folder, "seven-joints-friction.svg"));
}
if (values.delays) drawDelays(values.delays, join(folder, "detection-delays.svg"));
if (values.names) drawNames(values.names, "torque 10 and 30", join(folder, "which-fault.svg"));
