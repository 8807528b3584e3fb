// What one control tick costs on a Cortex-M: instructions under QEMU's -icount, stack, flash, RAM.
//   node target_counts.mjs --builds <build folder> [--json] [--compare FILE | --write FILE]
// `./dev bench target` builds what it needs and runs it; docs/firmware.md explains the numbers.
// Exit: 0 done, 1 a count differs from the file of --compare, 2 it could not be done.
import { spawnSync } from "node:child_process";
import { existsSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const twoJoints = { name: "two_link", joints: 2, hidden: 35 };
const sixJoints = { name: "arm6", joints: 6, hidden: 35 };
const sevenJoints = { name: "arm7", joints: 7, hidden: 64 };
const inTorqueSpace = { space: " torque", scalars: ["float"] };
const twoByJoint = { ...twoJoints, ...inTorqueSpace, name: "two_link_torque" };
const sevenByJoint = { ...sevenJoints, ...inTorqueSpace, name: "arm7_torque" };
const sevenIsolating = { ...sevenByJoint, space: " torque, isolation", name: "arm7_isolation" };
const sevenTwoFilters = { ...sevenByJoint, space: " torque, two filters", name: "arm7_filters" };
const boards = [
  {
    preset: "cortex-m7", machine: "mps2-an500", scalars: ["float", "double"],
    robots: [twoJoints, sixJoints, sevenJoints, twoByJoint, sevenByJoint, sevenIsolating,
      sevenTwoFilters],
  },
  { preset: "cortex-m4", machine: "mps2-an386", scalars: ["float"], robots: [twoJoints] },
];
const tolerance = 0.02; // both sides

function stop(message) {
  process.stderr.write(`target_counts: ${message}\n`);
  process.exit(2);
}

// Both streams: QEMU writes what semihosting prints to its standard error.
function output(program, args) {
  const options = { encoding: "utf8", maxBuffer: 1 << 28, timeout: 300_000 };
  const run = spawnSync(program, args, options);
  if (run.error?.code === "ENOENT") stop(`no ${program}: ./dev setup installs it`);
  if (run.error || run.status !== 0) {
    stop(`${program} ${args.join(" ")}: ${run.error ?? `exit ${run.status}`}\n${run.stdout}${run.stderr}`);
  }
  return run.stdout + run.stderr;
}

// Frames and calls of every function that was compiled with -fcallgraph-info=su.
function graphOf(file) {
  const text = readFileSync(file, "utf8");
  // Functions of the unit's own carry its name before theirs.
  const plain = (title) => title.replace(/^.*:/, "");
  const nodes = new Map();
  for (const [, title, label] of text.matchAll(/node: \{ title: "([^"]*)" label: "([^"]*)"/g)) {
    const frame = label.match(/\\n(\d+) bytes \(([a-z,]+)\)/);
    if (frame === null) continue;
    if (frame[2] !== "static") stop(`${file}: ${title} has a stack of ${frame[2]} size`);
    nodes.set(plain(title), { frame: Number(frame[1]), calls: new Set() });
  }
  const edges = /edge: \{ sourcename: "([^"]*)" targetname: "([^"]*)"/g;
  for (const [, from, to] of text.matchAll(edges)) {
    if (to === "__indirect_call") stop(`${file}: ${from} calls what nobody knows`);
    nodes.get(plain(from))?.calls.add(plain(to));
  }
  return nodes;
}

// Bytes of a floating-point register or of a range of them: s16, d8-d11.
function floatBytes(list) {
  const registers = list.trim().match(/^([sd])(\d+)(?:-[sd](\d+))?$/);
  if (registers === null) stop(`floating-point registers: found ${list}`);
  const [, kind, first, last] = registers;
  return (Number(last ?? first) - Number(first) + 1) * (kind === "d" ? 8 : 4);
}

// The same of functions that come compiled (memcpy and the like), from their instructions.
function graphOfImage(image) {
  const nodes = new Map();
  let node = null;
  for (const line of output("arm-none-eabi-objdump", ["-d", "--no-show-raw-insn", image]).split("\n")) {
    const head = line.match(/^[0-9a-f]+ <(.+)>:$/);
    if (head !== null) {
      node = { frame: 0, calls: new Set() };
      nodes.set(head[1], node);
      continue;
    }
    const parts = line.split("\t");
    if (node === null || parts.length < 3) continue;
    const [, operation, operands] = parts;
    const pushed = operation.startsWith("push") || operation.startsWith("stmdb");
    if (pushed && (operation.startsWith("push") || operands.startsWith("sp!"))) {
      node.frame += 4 * operands.match(/\{.*\}/)[0].split(",").length;
    } else if (operation.startsWith("vpush")) {
      node.frame += operands.match(/\{(.*)\}/)[1].split(",").reduce((sum, list) => sum + floatBytes(list), 0);
    } else if (/^v?str/.test(operation) && /\[sp, #-\d+\]!/.test(operands)) {
      node.frame += Number(operands.match(/#-(\d+)\]!/)[1]);
    } else if (operation.startsWith("sub") && /^sp, (sp, )?#/.test(operands)) {
      node.frame += Number(operands.match(/#(\d+)/)[1]);
    } else if (/^bl?(\.[nw])?$/.test(operation)) {
      const target = operands.match(/<([^+>]+)>$/);
      if (target !== null) node.calls.add(target[1]);
    }
  }
  return nodes;
}

// Bytes of the deepest path from `root`.
function deepest(root, own, image) {
  const known = new Map();
  const visit = (name, path) => {
    if (path.includes(name)) stop(`recursion: ${[...path, name].join(" -> ")}`);
    if (known.has(name)) return known.get(name);
    const node = own.get(name) ?? image.get(name);
    if (node === undefined) stop(`nothing is known of the stack of ${name}`);
    let below = 0;
    for (const callee of node.calls) {
      // A jump inside a compiled function is no call; what the linker took out is never reached.
      if (callee !== name && image.has(callee)) below = Math.max(below, visit(callee, [...path, name]));
    }
    known.set(name, node.frame + below);
    return node.frame + below;
  };
  return visit(root, []);
}

function onlyFile(folder, ending) {
  if (!existsSync(folder)) stop(`${folder} is not there: ./dev firmware builds it`);
  const found = readdirSync(folder, { recursive: true }).filter((file) => String(file).endsWith(ending));
  if (found.length !== 1) stop(`${folder}: ${found.length} files *${ending}, expected one`);
  return join(folder, String(found[0]));
}

function countsOf(builds, board, robot, scalar) {
  const folder = join(builds, board.preset, "targets", "cortex_m");
  const name = `${robot.name}_${scalar}`;
  const image = join(folder, `counts_${name}.elf`);
  const tick = join(folder, `tick_${name}.elf`);
  for (const file of [image, tick]) {
    if (!existsSync(file)) stop(`${file} is not there: ./dev firmware builds it`);
  }
  const text = output("qemu-system-arm", [
    "-M", board.machine, "-nographic", "-icount", "shift=0",
    "-semihosting-config", "enable=on,target=native", "-kernel", image,
  ]);
  const counts = {};
  let painted = 0;
  for (const line of text.trim().split("\n")) {
    const [what, ...numbers] = line.split(",");
    if (what === "ram") {
      counts["RAM"] = numbers.reduce((sum, number) => sum + Number(number), 0);
      continue;
    }
    counts[`tick ${what}`] = Number(numbers[0]);
    if (what !== "arming") counts[`monitor ${what}`] = Number(numbers[1]);
    painted = Math.max(painted, Number(numbers[2]));
  }
  for (const what of ["healthy", "adapting", "projecting", "worst", "arming"]) {
    if (!(counts[`tick ${what}`] > 0)) stop(`${image} said nothing of ${what}:\n${text}`);
  }
  counts["stack painted"] = painted;
  const graph = onlyFile(join(folder, "CMakeFiles", `tick_${name}_object.dir`), ".ci");
  counts["stack static"] = deepest("offnominal_tick", graphOf(graph), graphOfImage(tick));
  if (painted > counts["stack static"]) {
    stop(`${image}: a painted stack of ${painted} bytes, and the deepest path has ${counts["stack static"]}`);
  }
  const [flash, data] = output("arm-none-eabi-size", [tick]).trim().split("\n")[1].trim().split(/\s+/);
  counts["flash"] = Number(flash) + Number(data);
  return counts;
}

const columns = [
  "tick healthy", "tick adapting", "tick projecting", "tick worst", "tick arming", "monitor worst",
  "stack static", "stack painted", "flash", "RAM",
];

function print(all) {
  const width = Math.max(...Object.keys(all).map((name) => name.length));
  const line = (name, cells) =>
    console.log(name.padEnd(width) + cells.map((cell, i) => String(cell).padStart(Math.max(columns[i].length, 5) + 2)).join(""));
  console.log("instructions per tick (QEMU -icount shift=0; not cycles), bytes of stack, flash and RAM");
  line("", columns);
  for (const [name, counts] of Object.entries(all)) {
    line(name, columns.map((column) => counts[column]));
  }
  console.log("\nspread of the whole tick over healthy ... worst found");
  for (const [name, counts] of Object.entries(all)) {
    const ticks = ["healthy", "adapting", "projecting", "worst"].map((what) => counts[`tick ${what}`]);
    const spread = 100 * (Math.max(...ticks) / Math.min(...ticks) - 1);
    console.log(`${name.padEnd(width)}  ${spread.toFixed(2)} %`);
  }
}

function compare(all, file) {
  const baseline = JSON.parse(readFileSync(file, "utf8"));
  let wrong = 0;
  const say = (text) => {
    ++wrong;
    console.error(text);
  };
  const names = new Set([...Object.keys(all), ...Object.keys(baseline)]);
  for (const name of names) {
    for (const column of new Set([...Object.keys(all[name] ?? {}), ...Object.keys(baseline[name] ?? {})])) {
      const now = all[name]?.[column];
      const before = baseline[name]?.[column];
      if (now === undefined || before === undefined) {
        say(`${name}, ${column}: ${before} in ${file}, ${now} here`);
      } else if (Math.abs(now - before) > tolerance * before) {
        const change = 100 * (now / before - 1);
        say(`${name}, ${column}: ${now}, ${change.toFixed(1)} % off ${before}; allowed: ${100 * tolerance} %`);
      }
    }
  }
  if (wrong > 0) {
    console.error(`${wrong} counts differ; where that is meant: ./dev bench target --write ${file}`);
    process.exit(1);
  }
  console.log(`every count is within ${100 * tolerance} % of ${file}`);
}

const known = { "--builds": true, "--compare": true, "--write": true, "--json": false };
const options = {};
for (let i = 2; i < process.argv.length; ++i) {
  const name = process.argv[i];
  if (!(name in known)) stop(`${name} is no option; allowed: ${Object.keys(known).join(", ")}`);
  options[name] = known[name] ? process.argv[++i] : true;
  if (options[name] === undefined) stop(`${name} needs a value`);
}
if (options["--builds"] === undefined) stop("--builds <folder> is needed");

const all = {};
for (const board of boards) {
  for (const scalar of board.scalars) {
    for (const robot of board.robots) {
      if (!(robot.scalars ?? board.scalars).includes(scalar)) continue;
      const name = `${board.preset} ${scalar} ${robot.joints} joints L=${robot.hidden}${robot.space ?? ""}`;
      all[name] = countsOf(options["--builds"], board, robot, scalar);
    }
  }
}
if (options["--json"]) console.log(JSON.stringify(all));
else print(all);
if (options["--write"] !== undefined) {
  writeFileSync(options["--write"], `${JSON.stringify(all, null, 2)}\n`);
}
if (options["--compare"] !== undefined) compare(all, options["--compare"]);
