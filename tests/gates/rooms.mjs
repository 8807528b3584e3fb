// The arrows between the rooms of the desk: what the files of a room include is what its CMakeLists.txt
// says that it uses, and nothing else.
//   node rooms.mjs DESK ROOMS.TXT      ROOMS.TXT: a line `room:used used` each, from the ground up
import { readdirSync, readFileSync } from "node:fs";
import { join, relative } from "node:path";

const [desk, list] = process.argv.slice(2);
// The second: before Node 20.
const folderOf = (entry) => entry.parentPath ?? entry.path;
const rooms = new Map(
  readFileSync(list, "utf8").trim().split("\n").map((line) => {
    const [room, uses] = line.split(":");
    return [room, new Set(uses.split(" ").filter((name) => name !== ""))];
  }),
);
const below = new Set();
const wrong = [];
for (const [room, uses] of rooms) {
  for (const used of uses) if (!below.has(used)) wrong.push(`${room} uses ${used}, which is not below it`);
  below.add(room);
  const included = new Set();
  const folder = join(desk, room);
  for (const entry of readdirSync(folder, { recursive: true, withFileTypes: true })) {
    if (!entry.isFile() || !/\.(cpp|hpp|in)$/.test(entry.name) || folderOf(entry).includes("node_modules")) continue;
    const path = join(folderOf(entry), entry.name);
    readFileSync(path, "utf8").split("\n").forEach((line, i) => {
      const other = line.match(/^#include "([a-z_]+)\//)?.[1];
      if (other === undefined || other === room || (!rooms.has(other) && other !== "command")) return;
      included.add(other);
      if (!uses.has(other)) wrong.push(`desk/${relative(desk, path)}:${i + 1}: ${room} does not use ${other}`);
    });
  }
  for (const used of uses) if (!included.has(used)) wrong.push(`desk/${room}/CMakeLists.txt: nothing of ${used} is included`);
}
for (const line of wrong) console.error(line);
console.error(`${rooms.size} rooms, ${wrong.length} wrong arrows`);
process.exit(rooms.size > 1 && wrong.length === 0 ? 0 : 1);
