// The errors of one file, tried on its tests.
import { spawnSync } from "node:child_process";
import { cpSync, existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { basename, join, relative } from "node:path";
import { inParallel, killed, run, workFolder, workers } from "./jobs.mjs";
import { Refused } from "./refused.mjs";
import { mutated, schemaOf } from "./schema.mjs";
import { moved, testsOf } from "./tests_of.mjs";

const own = import.meta.dirname;
// As little as makes the tests quick, and an index out of range ends the program.
const flags = ["-O1", "-g0", "-w", "-UNDEBUG", "-D_GLIBCXX_ASSERTIONS", "-include", join(own, "active.hpp")];
const memory_kb = 16_000_000;

let work;
let edges;

export class Trial {
  constructor(settings) {
    Object.assign(this, settings);
    work ??= workFolder();
    edges ??= edgesOf(this.build);
    this.tests = testsOf(this.path, this.reach, edges, this.root, this.build);
    for (const test of this.tests) test.files = this.filesBehind(test.needs);
    this.tests.sort((a, b) => a.distance - b.distance || a.files - b.files);
    if (this.tests.length === 0) {
      throw new Refused(`${this.file}: no test comes to it over at most ${this.reach} includes (--reach)`);
    }
  }

  note(text) {
    process.stderr.write(`mutate: ${this.file}: ${text}\n`);
  }

  // Of how many files ninja builds these.
  filesBehind(needs) {
    if (needs.length === 0) return 0;
    const options = { encoding: "utf8", maxBuffer: 1 << 28 };
    return spawnSync("ninja", ["-C", this.build, "-t", "inputs", ...needs], options).stdout.split("\n").length;
  }

  // Every error: outcome caught (by: which program), refused (by the compiler) or survived. reached:
  // whether a test comes by, where that is known.
  async run() {
    const left = () => this.mutants.filter(({ outcome }) => outcome === undefined);
    this.together = new Set(this.mutants.filter(({ region }) => !region.alone));
    // What the compiler computes is right where all errors are together.
    const isKnown = (mutant) =>
      this.together.has(mutant) && (mutant.reason || (mutant.reached && !mutant.region.constant));
    let tried = 0;
    for (const test of this.tests) {
      if (tried > 0 && left().every(({ reason }) => reason)) break;
      if (!(await this.tryTogether(test))) continue;
      ++tried;
      await this.tryAlone(left().filter((mutant) => !isKnown(mutant)), test);
    }
    if (tried === 0) throw new Refused(`${this.file}: no test program of it runs without an error`);
    for (const mutant of left()) mutant.outcome = "survived";
    for (let worker = 0; worker < workers; ++worker) this.write(worker, this.text);
  }

  async tryTogether(test) {
    if (test.needs.length > 0) {
      const built = await run(["ninja", "-C", this.build, "-j", workers, ...test.needs]);
      if (built.code !== 0) throw new Refused(`${test.program}: what it needs cannot be built:\n${built.text}`);
    }
    const began = Date.now();
    const folder = join(work, "together");
    const program = await this.buildTogether(test, folder);
    const built = Date.now();
    const reached = join(folder, "reached");
    rmSync(reached, { force: true });
    const first = await this.start(test, program, { OFFNOMINAL_MUTANTS_REACHED: reached }, 600, folder);
    test.seconds = Math.ceil((5 * (Date.now() - built)) / 1000 + 3);
    if (first.code !== 0 || !existsSync(reached)) {
      this.note(`${test.program} left out: without an error it ends with ${first.code}`);
      return false;
    }
    const numbers = new Set(readFileSync(reached, "utf8").split("\n").map(Number));
    const open = this.mutants.filter((mutant) => mutant.outcome === undefined && this.together.has(mutant));
    for (const mutant of open) mutant.reached ||= numbers.has(mutant.number);
    const tried = open.filter(({ number }) => numbers.has(number));
    await inParallel(tried, async (mutant, worker) => {
      const place = join(work, `tree${worker}`);
      const { code } = await this.start(test, program, { OFFNOMINAL_MUTANT: mutant.number }, test.seconds, place);
      if (code !== 0) this.isCaught(mutant, test, code);
    });
    const caught = tried.filter(({ outcome }) => outcome === "caught").length;
    const seconds = (from, to) => `${((to - from) / 1000).toFixed(0)} s`;
    const times = [seconds(began, built), seconds(built, Date.now())];
    this.note(`${test.program}: built in ${times[0]}, caught ${caught} of ${tried.length} in ${times[1]}`);
    return true;
  }

  // Without the errors that do not compile in there, most of which the first unit tells.
  async buildTogether(test, folder) {
    mkdirSync(folder, { recursive: true });
    for (let units = test.units.slice(0, 1); ; ) {
      const schema = schemaOf(this.text, this.parsed, [...this.together]);
      for (let worker = 0; worker < workers; ++worker) this.write(worker, schema.text);
      const said = await inParallel(units, (unit, worker) =>
        this.compile(unit, join(folder, objectOf(test, unit)), worker));
      if (said.some((text) => text !== undefined)) this.setApart(test, schema, said);
      else if (units.length === test.units.length) break;
      else units = test.units;
    }
    return this.link(test, folder);
  }

  // The errors that the compiler speaks of.
  setApart(test, { lines }, said) {
    const concerned = new Set(said.flatMap((text) =>
      [...(text ?? "").matchAll(/([^\s:]+):(\d+):\d+: /g)].filter(([, file]) => file.endsWith(`/${this.file}`))
        .map(([, , line]) => lines.get(Number(line))).filter((mutant) => mutant !== undefined)));
    if (concerned.size === 0) {
      throw new Refused(`${test.program} does not compile:\n${said.find((text) => text !== undefined)}`);
    }
    for (const mutant of concerned) this.together.delete(mutant);
  }

  async tryAlone(mutants, test) {
    if (mutants.length === 0) return;
    this.note(`${test.program}: ${mutants.length} to be built by themselves`);
    let done = 0;
    await inParallel(mutants, async (mutant, worker) => {
      const folder = join(work, `alone${worker}`);
      mkdirSync(folder, { recursive: true });
      this.write(worker, mutated(this.text, mutant));
      await this.tryOne(mutant, test, folder, worker);
      if (++done % 10 === 0) this.note(`${done} of ${mutants.length}`);
    });
  }

  async tryOne(mutant, test, folder, worker) {
    for (const unit of test.units) {
      if ((await this.compile(unit, join(folder, objectOf(test, unit)), worker)) !== undefined) {
        mutant.outcome = "refused";
        return;
      }
    }
    const { code } = await this.start(test, await this.link(test, folder), {}, test.seconds, folder);
    if (code !== 0) this.isCaught(mutant, test, code);
  }

  // overdue: by its time alone, of which another machine may have enough.
  isCaught(mutant, test, code) {
    Object.assign(mutant, { outcome: "caught", by: test.program, overdue: code === killed });
  }

  // The file of a worker's own tree, a copy of ours as it was when this began.
  write(worker, text) {
    const folder = join(work, `tree${worker}`);
    if (!existsSync(folder)) {
      const others = [join(this.root, ".git"), join(this.root, relative(this.root, this.build).split("/")[0])];
      const filter = (path) => basename(path) !== "node_modules" && !others.includes(path);
      cpSync(this.root, folder, { recursive: true, filter });
    }
    writeFileSync(join(folder, this.file), text);
  }

  // What the compiler says where it fails.
  async compile({ files, compile }, object, worker) {
    const tree = join(work, `tree${worker}`);
    const ours = (word) => moved(word, this.root, this.build, tree);
    const source = `${object}.cpp`;
    writeFileSync(source, files.map((file) => `#include "${ours(file)}"\n`).join(""));
    const words = compile.map((word) => ({ "{object}": object, "{source}": source })[word] ?? ours(word));
    words.splice(words.indexOf("-c"), 0, ...flags);
    const { code, text } = await run(words, { cwd: this.build });
    return code === 0 ? undefined : text;
  }

  async link(test, folder) {
    const active = join(work, "active.o");
    if (!existsSync(active)) {
      const compiled = await run([test.link[0], "-std=c++20", "-O1", "-c", join(own, "active.cpp"), "-o", active]);
      if (compiled.code !== 0) throw new Refused(compiled.text);
    }
    const program = join(folder, "program");
    const objects = [...test.units.map((unit) => join(folder, objectOf(test, unit))), active];
    const words = test.link.flatMap((word) => ({ "{objects}": objects, "{program}": [program] })[word] ?? [word]);
    const { code, text } = await run(words, { cwd: this.build });
    if (code !== 0) throw new Refused(`${test.program} does not link:\n${text}`);
    return program;
  }

  start(test, program, variables, seconds, temporary) {
    const env = { ...process.env, TMPDIR: temporary, GTEST_FAIL_FAST: "1", GTEST_BRIEF: "1", ...variables };
    return run([program], { cwd: test.folder, env, seconds, memory_kb });
  }
}

function edgesOf(build) {
  const options = { encoding: "utf8", maxBuffer: 1 << 28 };
  const ninja = spawnSync("ninja", ["-C", build, "-t", "compdb"], options);
  if (ninja.status !== 0) throw new Refused(`ninja -t compdb in ${build}: ${ninja.error ?? ninja.stderr}`);
  return JSON.parse(ninja.stdout.slice(ninja.stdout.indexOf("[\n")));
}

function objectOf(test, unit) {
  return `unit${test.units.indexOf(unit)}.o`;
}
