// A name of a namespace stands for one type: two that differ link without a word, and one file then reads
// the other's layout. Looks at struct, class and enum definitions outside of unnamed namespaces and of
// other types, in the layout of clang-format: a namespace opens and closes at the start of a line.
//   node one_type.mjs FOLDER...     exit 1: some name is defined at two places
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";

const places = new Map();
let files = 0;

function look(path) {
  const open = [];
  readFileSync(path, "utf8").split("\n").forEach((line, i) => {
    const space = line.match(/^(?:inline )?namespace ?([\w:]*) ?\{(\})?/);
    if (space) {
      if (!space[2]) open.push(space[1]);
      return;
    }
    if (/^\}.*\/\/ namespace/.test(line)) {
      open.pop();
      return;
    }
    // Full specialisations are types of their own.
    const type = line.match(/^(?:struct|class|enum class|enum) (?:\[\[\w+\]\] )?([\w:]+(?:<[^{]*>)?)(?:[^;]*\{|[^;]*$)/);
    if (!type || open.includes("")) return;
    const name = [...open, type[1]].join("::");
    places.set(name, [...(places.get(name) ?? []), `${path}:${i + 1}`]);
  });
}

for (const folder of process.argv.slice(2)) {
  for (const entry of readdirSync(folder, { recursive: true, withFileTypes: true })) {
    const path = join(entry.parentPath ?? entry.path, entry.name);
    if (!entry.isFile() || !/\.(cpp|hpp)$/.test(entry.name) || path.includes("node_modules")) continue;
    files += 1;
    look(path);
  }
}
const twice = [...places].filter(([, where]) => where.length > 1);
for (const [name, where] of twice) console.error(`${name}: ${where.join(", ")}`);
console.error(`${files} files, ${places.size} types, ${twice.length} names that stand for two`);
process.exit(files > 0 && places.size > 0 && twice.length === 0 ? 0 : 1);
