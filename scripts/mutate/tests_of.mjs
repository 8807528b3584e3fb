// Which tests a file reaches, and how ninja builds them.
import { existsSync, readFileSync, statSync } from "node:fs";
import { dirname, join, relative, resolve } from "node:path";

// Nearest first: [{program, folder, units: [{files, compile}], link, needs, distance}], the test programs
// with sources that come to `file` over at most `reach` includes; files of a unit are compiled as one.
// edges: what `ninja -t compdb` says. compile, link: words of a command; {source}, {object}, {objects} and
// {program} stand for what differs. needs: what ninja has to build before.
export function testsOf(file, reach, edges, root, build) {
  const byOutput = new Map(edges.map((edge) => [edge.output, edge]));
  const isTest = ({ output, command }) =>
    /^: && /.test(command) && !/\.(a|so)$/.test(output) && resolve(build, output).startsWith(join(build, "tests/"));
  return edges.filter(isTest).map((edge) => testOf(file, reach, edge, byOutput, root, build))
    .filter((test) => test.distance <= reach && !needsBus(resolve(build, test.program)))
    .sort((a, b) => a.distance - b.distance || a.units.length - b.units.length || (a.program < b.program ? -1 : 1));
}

function testOf(file, reach, edge, byOutput, root, build) {
  const words = wordsOf(edge.command.replace(/^: && /, "").split(" && ")[0]);
  const isOwn = (word) => word.endsWith(".o") && byOutput.has(word);
  const units = words.filter(isOwn).map((object) => unitOf(byOutput.get(object), build));
  const distances = new Map(units.flatMap(({ files, compile }) =>
    files.map((source) => [source, distance(file, source, compile, root)])));
  // Without the tests that the file does not reach.
  const isWanted = (source) => distances.get(source) <= reach || !/_test\.cpp$/.test(source);
  const link = words.flatMap((word, i) => {
    if (!isOwn(word)) return [word === edge.output ? "{program}" : word];
    return words.slice(0, i).some(isOwn) ? [] : ["{objects}"];
  });
  return {
    program: edge.output,
    folder: dirname(resolve(build, edge.output)),
    units: units.map(({ files, compile }) => ({ files: files.filter(isWanted), compile }))
      .filter(({ files }) => files.length > 0),
    link,
    needs: [
      ...words.filter((word) => /\.(a|so)$/.test(word)),
      `cmake_object_order_depends_target_${edge.output.split("/").at(-1)}`,
    ].filter((output) => byOutput.has(output)),
    distance: Math.min(...distances.values(), Infinity),
  };
}

// A unit, or those that CMake has put together in it.
function unitOf({ command, file, output }, build) {
  const words = wordsOf(command);
  const compiler = words.findIndex((word) => !/^(env|ccache|\S+\/ccache|\w+=.*)$/.test(word));
  const compile = words.slice(compiler).filter((word, i, all) => {
    return !/^-(MD|MT|MF)$/.test(word) && !/^-M[TF]$/.test(all[i - 1]);
  }).map((word, i, all) => {
    if (all[i - 1] === "-o") return "{object}";
    return word === file ? "{source}" : word;
  });
  const path = resolve(build, file);
  const files = /\/Unity\/unity_\d+_\w+\.cxx$/.test(path)
    ? [...readFileSync(path, "utf8").matchAll(/#include "([^"]+)"/g)].map((match) => match[1])
    : [path];
  return { files, compile };
}

// Whether its cases need CAN buses or a clock that nobody makes late.
function needsBus(program) {
  const registered = `${program}[1]_include.cmake`;
  return existsSync(registered) && /LABELS;(bus|real_time)\b/.test(readFileSync(registered, "utf8"));
}

// A command's words, as a shell takes them; no expansions.
function wordsOf(command) {
  return [...command.matchAll(/(?:[^\s"'\\]|\\.|"(?:[^"\\]|\\.)*"|'[^']*')+/g)].map(([word]) =>
    word.replace(/\\(.)|"((?:[^"\\]|\\.)*)"|'([^']*)'/g, (_, escaped, double, single) =>
      escaped ?? double?.replace(/\\(["\\$`])/g, "$1") ?? single));
}

const included = new Map();

// Over how many includes a unit reaches the file; Infinity where it does not.
function distance(file, source, compile, root) {
  const folders = compile.flatMap((word, i) => {
    if (/^-I./.test(word)) return [word.slice(2)];
    return /^-(I|isystem)$/.test(compile[i - 1]) ? [word] : [];
  }).filter((folder) => folder.startsWith(root));
  const seen = new Set([source]);
  let front = [source];
  for (let steps = 0; front.length > 0; ++steps) {
    if (front.includes(file)) return steps;
    front = front.flatMap((at) => includesOf(at).map(({ name, quoted }) =>
      [...(quoted ? [dirname(at)] : []), ...folders].map((folder) => join(folder, name)).find(isFile)))
      .filter((path) => path !== undefined && !seen.has(path) && seen.add(path));
  }
  return Infinity;
}

const isFile = (path) => statSync(path, { throwIfNoEntry: false })?.isFile() ?? false;

function includesOf(file) {
  if (!included.has(file)) {
    const lines = readFileSync(file, "utf8").matchAll(/^[ \t]*#[ \t]*include[ \t]+([<"])([^>"]+)[>"]/gm);
    included.set(file, [...lines].map(([, sign, name]) => ({ name, quoted: sign === '"' })));
  }
  return included.get(file);
}

// Where the shadow of a tree has its files: the same command for another root, but for what is built.
export function moved(word, root, build, shadow) {
  const built = relative(root, build);
  return word.replaceAll(`${root}/`, `${shadow}/`).replaceAll(`${shadow}/${built}/`, `${build}/`);
}
