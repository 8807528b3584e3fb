// Runs the commands of a document in a folder of their own, in their order, and compares what they print with
// what the document shows:
//   node check_walkthrough.mjs DOCUMENT.md --offnominal COMMAND --project FOLDER [--section HEADING] [--keep FOLDER]
// --section: what stands under that heading alone. --keep: the commands run in that folder, which stays.
// Recordings: OFFNOMINAL_DATA, else ../shared/data beside the project.
// Exit 0: it says what the program says. Exit 1: one line per difference on stderr. Exit 77: the recordings of
// the document are not there.
//
// How a document is read:
// - A block ```sh is run by a shell, in the project's folder. The block without a language behind it is what it
//   prints, stderr and stdout as they come. A command that shows no output has to succeed.
// - `...` as the beginning of a path is the project's folder. In an output a line `...` stands for any number
//   of lines, `...` in a line for what is between its beginning and its end. <!-- lines are left out --> before it: lines are
//   missing anywhere, and those that are shown stand in their order.
// - <!-- file: build/x.toml --> before a block makes it that file. Blocks of other languages are not read.
// Words are compared as they are; numbers may be off by what another compiler makes of them.
import { spawnSync } from "node:child_process";
import { existsSync } from "node:fs";
import { chmod, mkdir, mkdtemp, readFile, rm, symlink, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { parseArgs } from "node:util";

const kSkipped = 77;
const kRelative = 5e-3;

function readArguments() {
  const text = { type: "string" };
  const { values, positionals } = parseArgs({
    allowPositionals: true,
    options: { offnominal: text, project: text, section: text, keep: text },
  });
  if (positionals.length !== 1 || !values.offnominal || !values.project)
    throw new Error("DOCUMENT.md, --offnominal and --project are needed");
  const data = process.env.OFFNOMINAL_DATA || join(values.project, "..", "shared", "data");
  return { document: positionals[0], data, ...values };
}

/** Blocks of the document: {language, file, gaps, text, line}, the line that of its first line of text. */
function blocksOf(markdown) {
  const blocks = [];
  let open = null;
  let marks = {};
  markdown.split("\n").forEach((line, index) => {
    if (open !== null) {
      if (line === "```") {
        blocks.push({ ...open, text: open.lines.join("\n") });
        open = null;
      } else {
        open.lines.push(line);
      }
      return;
    }
    const fence = line.match(/^```(\w*)$/);
    if (fence) {
      open = { language: fence[1], ...marks, lines: [], line: index + 2 };
      marks = {};
      return;
    }
    const file = line.match(/^<!-- file: (\S+) -->$/);
    if (file) marks.file = file[1];
    else if (line === "<!-- lines are left out -->") marks.gaps = true;
    else if (line.startsWith("<!--")) throw new Error(`line ${index + 1}: found ${line}; allowed: file, lines`);
  });
  return blocks;
}

/** The document with every line blank that does not stand under `heading`: lines keep their numbers. */
function sectionOf(markdown, heading) {
  let level = 0;
  let fenced = false;
  const lines = markdown.split("\n").map((line) => {
    if (line.startsWith("```")) fenced = !fenced;
    const [, marks, title] = (fenced ? null : line.match(/^(#+) (.*)$/)) ?? [];
    if (title === heading) level = marks.length;
    else if (level > 0 && marks && marks.length <= level) level = -1;
    return level > 0 ? line : "";
  });
  if (level === 0) throw new Error(`--section: found no heading "${heading}"`);
  return lines.join("\n");
}

/** Commands with what the document shows of each, files before them. */
function stepsOf(blocks) {
  const steps = [];
  let command = null;
  let files = [];
  const finish = (shown) => {
    if (command !== null) steps.push({ command, files, shown });
    else if (shown !== null) throw new Error(`line ${shown.line}: an output without a command before it`);
    command = null;
    files = [];
  };
  for (const block of blocks) {
    if (block.file) {
      files.push(block);
    } else if (block.language === "sh") {
      const before = files;
      if (command !== null) {
        files = [];
        finish(null);
      }
      files = before;
      command = block;
    } else if (block.language === "") {
      finish(block);
    }
  }
  finish(null);
  return steps;
}

const kNumber = /[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?/g;

/** Whether numbers are the same but for rounding: 0.5 %, or one of the last digit that is shown. */
function areClose(shown, said) {
  const decimals = (shown.match(/\.(\d+)/) ?? ["", ""])[1].length;
  const exponent = Number((shown.match(/e([-+]?\d+)/) ?? ["", "0"])[1]);
  const lastDigit = 10 ** (exponent - decimals);
  const off = Math.abs(Number(shown) - Number(said));
  // A count is what it is.
  if (!/[.e]/.test(shown) && !/[.e]/.test(said)) return off === 0;
  return off <= Math.max(kRelative * Math.abs(Number(shown)), 1.01 * lastDigit);
}

/** Whether a line that is shown says what the program said. */
function saysTheSame(shown, said) {
  const parts = shown.split(/\.\.\.(?!\/)/);
  if (parts.length > 1) {
    const [begin, end] = [parts[0].trimEnd(), parts[parts.length - 1]];
    if (said.length < begin.length + end.length || !said.endsWith(end)) return false;
    return saysTheSame(begin, said.slice(0, begin.length));
  }
  if (shown === said) return true;
  const words = (line) => line.replace(kNumber, "#").replace(/\s+/g, " ").trim();
  if (words(shown) !== words(said)) return false;
  const numbers = [shown.match(kNumber) ?? [], said.match(kNumber) ?? []];
  return numbers[0].every((number, i) => areClose(number, numbers[1][i]));
}

/** The first line that is shown and not said, by its index in what is shown; null where all is the same. */
function firstDifference(shown, said, gaps) {
  let at = 0;
  let loose = gaps;
  for (let i = 0; i < shown.length; ++i) {
    if (shown[i] === "...") {
      loose = true;
      continue;
    }
    let found = at;
    while (loose && found < said.length && !saysTheSame(shown[i], said[found])) ++found;
    if (found >= said.length || !saysTheSame(shown[i], said[found]))
      return { index: i, said: said[at] ?? "(nothing more)" };
    at = found + 1;
    loose = gaps;
  }
  if (at < said.length && !loose) return { index: shown.length - 1, said: `and then: ${said[at]}` };
  return null;
}

/** A project as the document sees it: `dev`, `robots`, `bench`, an empty `build`, recordings beside it. */
async function makeProject(folder, options) {
  const project = join(folder, "offnominal");
  await mkdir(join(project, "build"), { recursive: true });
  await mkdir(join(folder, "shared"));
  for (const name of ["robots", "bench"]) await symlink(resolve(options.project, name), join(project, name));
  await symlink(resolve(options.data), join(folder, "shared", "data"));
  const dev = join(project, "dev");
  await writeFile(dev, `#!/bin/sh\nshift\nexec '${resolve(options.offnominal)}' "$@"\n`);
  await chmod(dev, 0o755);
  return project;
}

async function check(document, options, folder) {
  const project = await makeProject(folder, options);
  let faults = 0;
  const fault = (line, words) => {
    ++faults;
    process.stderr.write(`${document}: line ${line}: ${words}\n`);
  };
  const text = await readFile(document, "utf8");
  const steps = stepsOf(blocksOf(options.section ? sectionOf(text, options.section) : text));
  for (const { command, files, shown } of steps) {
    for (const file of files) {
      const path = join(project, file.file);
      await mkdir(dirname(path), { recursive: true });
      await writeFile(path, file.text + "\n");
    }
    const whole = command.text.replaceAll(/(^|[\s=])\.\.\.\//gm, `$1${project}/`);
    const run = spawnSync("/bin/sh", ["-e", "-c", `exec 2>&1\n${whole}`], { cwd: project, encoding: "utf8" });
    if (shown === null) {
      if (run.status !== 0) fault(command.line, `the command fails: ${run.stdout.trim()}`);
      continue;
    }
    const said = run.stdout.replaceAll(project, "...").trimEnd().split("\n");
    const off = firstDifference(shown.text.split("\n"), said, shown.gaps ?? false);
    if (off === null) continue;
    fault(shown.line + off.index, `shown: ${shown.text.split("\n")[off.index]}\n  said: ${off.said}`);
    if (process.env.OFFNOMINAL_SHOW_OUTPUT) process.stderr.write(`${said.join("\n")}\n`);
  }
  process.stdout.write(`${document}: ${steps.length} commands, ${faults} differences\n`);
  return faults === 0 && steps.length > 0;
}

const options = readArguments();
if (!existsSync(options.data)) {
  process.stdout.write(`no recordings at ${options.data}: skipped; OFFNOMINAL_DATA names their folder\n`);
  process.exit(kSkipped);
}
if (options.keep) await mkdir(options.keep, { recursive: true });
const folder = options.keep ? resolve(options.keep) : await mkdtemp(join(tmpdir(), "offnominal-walkthrough-"));
try {
  process.exitCode = (await check(options.document, options, folder)) ? 0 : 1;
} finally {
  if (!options.keep) await rm(folder, { recursive: true, force: true });
}
