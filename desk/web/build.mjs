// Bundles the page's modules into the scripts that the command embeds, or its unit tests:
//   node build.mjs OUT            report.js, studio.js and arm_view.js, into the folder OUT
//   node build.mjs OUT --tests    a script of each file in tests/, for `node --test OUT`
import { build } from "esbuild";
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { validatorsText } from "./api.mjs";

const web = fileURLToPath(new URL(".", import.meta.url));

const kCommon = {
  absWorkingDir: web,
  bundle: true,
  charset: "utf8",
  logLevel: "warning",
  target: "es2020",
};

/** Modules of these packages name their licences in comments that a bundle does not keep. */
function licenceOf(name, words) {
  const { version, license } = JSON.parse(readFileSync(join(web, "node_modules", name, "package.json"), "utf8"));
  return `/*! ${name} ${version}, ${words}, SPDX-License-Identifier: ${license} */`;
}

function licencesOfCharts() {
  return [
    licenceOf("echarts", "Apache ECharts, Copyright 2017-2026 The Apache Software Foundation"),
    licenceOf("zrender", "Copyright 2017 Baidu Inc."),
    licenceOf("tslib", "Copyright Microsoft Corporation"),
  ].join("\n");
}

/** What the modules import as "#validators" is made here. */
function withValidators(out) {
  const file = join(out, "validators.mjs");
  mkdirSync(out, { recursive: true });
  writeFileSync(file, validatorsText());
  return { alias: { "#validators": file } };
}

/** A script of the page: `entry` and all that it imports. */
async function script(out, entry, name, options) {
  const outfile = join(out, name);
  await build({ ...kCommon, ...options, entryPoints: [entry], outfile, minify: true, legalComments: "inline" });
  return outfile;
}

/** What a script inside a page must not hold: it would end there. */
function checkEmbeddable(file) {
  const text = readFileSync(file, "utf8");
  for (const words of ["</script", "<!--"]) {
    if (text.includes(words)) throw new Error(`${file} holds ${words}, where the page's script would end`);
  }
}

async function buildScripts(out) {
  const banner = { js: licencesOfCharts() };
  checkEmbeddable(await script(out, "report/main.ts", "report.js", { format: "iife", banner }));
  // The arm is a script of its own: what stands at once does not wait for three.js.
  await script(out, "studio/main.ts", "studio.js", {
    ...withValidators(out),
    format: "esm",
    banner,
    external: ["./arm_view.js"],
  });
  await script(out, "studio/arm_view.ts", "arm_view.js", { format: "esm" });
}

async function buildTests(out) {
  const tests = readdirSync(join(web, "tests")).filter((name) => name.endsWith(".test.ts"));
  await build({
    ...kCommon,
    ...withValidators(out),
    entryPoints: tests.map((name) => `tests/${name}`),
    outdir: out,
    outExtension: { ".js": ".mjs" },
    format: "esm",
    platform: "node",
    target: "node18",
    sourcemap: "inline",
  });
}

const [out, mode] = process.argv.slice(2);
if (out === undefined || ![undefined, "--tests"].includes(mode)) {
  console.error("node build.mjs OUT [--tests]");
  process.exit(2);
}
await (mode === "--tests" ? buildTests(resolve(out)) : buildScripts(resolve(out)));
