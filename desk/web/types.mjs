// Checks the types of all modules and of their tests, the answers of the server among them:
//   node types.mjs [OUT]     types made of the API go into the folder OUT, else into generated/, where editors look
import { spawnSync } from "node:child_process";
import { mkdirSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { typesText } from "./api.mjs";

const web = fileURLToPath(new URL(".", import.meta.url));

/** The project's settings with the types that lie in another folder. */
function settingsIn(out) {
  const settings = {
    extends: join(web, "tsconfig.json"),
    compilerOptions: { paths: { "#api": [join(out, "api.d.ts")] }, typeRoots: [join(web, "node_modules/@types")] },
    include: ["report", "studio", "tests"].map((folder) => join(web, folder)),
  };
  const file = join(out, "tsconfig.json");
  writeFileSync(file, `${JSON.stringify(settings, null, 2)}\n`);
  return file;
}

const inside = join(web, "generated");
const out = resolve(process.argv[2] ?? inside);
mkdirSync(out, { recursive: true });
writeFileSync(join(out, "api.d.ts"), await typesText());
const settings = out === inside ? join(web, "tsconfig.json") : settingsIn(out);
const { status } = spawnSync(process.execPath, [join(web, "node_modules/typescript/bin/tsc"), "--noEmit", "-p", settings], {
  stdio: "inherit",
});
process.exit(status ?? 2);
