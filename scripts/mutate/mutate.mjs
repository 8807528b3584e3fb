// Makes small errors in files, one by one, and lists those that no test sees.
//   node mutate.mjs --root DIR --build DIR --reasons FILE [OPTION...] FILE...
// `./dev mutate` builds what it needs and runs it; docs/mutate.md explains it.
// Exit: 0 none is left, 1 errors without a reason that nobody sees, or reasons without such an error, 2 it could
// not be done.
import { readFileSync } from "node:fs";
import { relative, resolve } from "node:path";
import { parseArgs } from "node:util";
import { mutantsOf } from "./mutants.mjs";
import { reasonFor, reasonsOf } from "./reasons.mjs";
import { Refused } from "./refused.mjs";
import { Trial } from "./trial.mjs";

const options = {
  root: { type: "string" }, build: { type: "string" }, reasons: { type: "string" },
  line: { type: "string", multiple: true }, most: { type: "string" }, reach: { type: "string", default: "2" },
  list: { type: "boolean" }, json: { type: "boolean" },
};

function wholeNumber(name, text, least) {
  if (!/^\d+$/.test(text) || Number(text) < least) {
    throw new Refused(`--${name}: found '${text}', allowed: a whole number from ${least}`);
  }
  return Number(text);
}

// Whether a line is one of those that --line names.
function lineFilter(ranges = []) {
  const known = ranges.map((range) => {
    const [, first, last] = range.match(/^(\d+)(?:-(\d+))?$/) ?? [];
    if (first === undefined) throw new Refused(`--line: found '${range}', allowed: a line or two of them, A-B`);
    return [Number(first), Number(last ?? first)];
  });
  return (line) => known.length === 0 || known.some(([first, last]) => first <= line && line <= last);
}

function textOf(path) {
  try {
    return readFileSync(path, "utf8");
  } catch (error) {
    throw new Refused(`${path}: cannot be read (${error.code})`);
  }
}

async function examine(name, settings) {
  const path = resolve(name);
  const file = relative(settings.root, path);
  if (file.startsWith("..")) throw new Refused(`${name}: not a file of ${settings.root}`);
  const text = textOf(path);
  let parsed;
  try {
    parsed = mutantsOf(text);
  } catch (error) {
    throw new Refused(`${file}: not understood as C++: ${error.message}`);
  }
  const mutants = parsed.mutants.filter(({ line }) => settings.wanted(line)).slice(0, settings.most);
  mutants.forEach((mutant, i) => {
    mutant.number = i + 1;
    mutant.reason = reasonFor(settings.reasons, file, mutant);
  });
  if (!settings.list) {
    const trial = new Trial({ ...settings, path, file, text, parsed, mutants });
    await trial.run();
  }
  for (const { outcome, overdue, reason } of mutants) if (reason && (outcome === "survived" || overdue)) ++reason.used;
  const isWhole = mutants.length === parsed.mutants.length;
  const isStale = (reason) => reason.file === file && reason.used === 0;
  const stale = settings.list || !isWhole ? [] : settings.reasons.filter(isStale);
  return { file, mutants, stale };
}

const shown = ({ before, after }) => `  - ${before}\n  + ${after}\n`;

function report({ file, mutants, stale }) {
  const count = (outcome) => mutants.filter((mutant) => mutant.outcome === outcome).length;
  const left = mutants.filter(({ outcome, reason }) => outcome === "survived" && !reason);
  let text = "";
  for (const mutant of left) {
    const what = mutant.reached === false ? "no test comes by" : "no test sees";
    text += `${file}:${mutant.line}: ${what}\n${shown(mutant)}`;
  }
  for (const reason of stale) text += `${file}: a reason for what is not there, or is seen\n${shown(reason)}`;
  const survived = count("survived");
  return text + `${file}: ${mutants.length} errors, ${count("caught")} caught, ${count("refused")} do not compile, ` +
    `${survived} survive, ${survived - left.length} of them for a reason\n`;
}

function plain({ file, mutants, stale }) {
  return {
    file,
    errors: mutants.map(({ line, before, after, outcome, by, reached, reason }) =>
      ({ line, before, after, outcome, by, reached, reason: reason?.why })),
    stale: stale.map(({ before, after, why }) => ({ before, after, why })),
  };
}

async function main() {
  const { values, positionals } = parseArgs({ options, allowPositionals: true });
  if (positionals.length === 0) throw new Refused("no file: ./dev mutate FILE...");
  const settings = {
    root: resolve(values.root), build: resolve(values.build), wanted: lineFilter(values.line),
    most: values.most === undefined ? Infinity : wholeNumber("most", values.most, 1),
    reach: wholeNumber("reach", values.reach, 1), list: values.list,
    reasons: reasonsOf(textOf(values.reasons), values.reasons),
  };
  const results = [];
  for (const name of positionals) {
    const result = await examine(name, settings);
    results.push(result);
    if (values.json) continue;
    if (values.list) {
      for (const mutant of result.mutants) process.stdout.write(`${result.file}:${mutant.line}:\n${shown(mutant)}`);
      process.stdout.write(`${result.file}: ${result.mutants.length} errors\n`);
    } else {
      process.stdout.write(report(result));
    }
  }
  if (values.json) process.stdout.write(`${JSON.stringify(results.map(plain), null, 2)}\n`);
  const isLeft = ({ outcome, reason }) => outcome === "survived" && !reason;
  process.exitCode = results.some(({ mutants, stale }) => stale.length > 0 || mutants.some(isLeft)) ? 1 : 0;
}

main().catch((error) => {
  const isOurs = error instanceof Refused || error.code?.startsWith("ERR_PARSE_ARGS");
  process.stderr.write(`mutate: ${isOurs ? error.message : error.stack}\n`);
  process.exit(2);
});
