// What every check of Studio in a browser does: starts `offnominal studio`, opens its page in headless Chromium, looks at
// it in several widths and colours, and ends both.
import { spawn } from "node:child_process";
import { createRequire } from "node:module";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { checkWithAxe, readAxe } from "./accessible.mjs";

/** A name that would be script where a page took it for markup. */
export const kScript = "<img src=x onerror=window.hacked=1>";

const web = fileURLToPath(new URL("../../desk/web/", import.meta.url));

/** Options of the command line: `needed` have to be there; `more` as parseArgs() has them. */
export function readArguments(needed, more = {}) {
  const text = { type: "string" };
  const { values } = parseArgs({
    options: {
      ...Object.fromEntries(needed.map((name) => [name, text])),
      screenshots: text,
      chromium: { type: "string", default: process.env.OFFNOMINAL_CHROMIUM ?? "/usr/bin/chromium" },
      ...more,
    },
  });
  for (const name of needed) {
    if (values[name] === undefined) throw new Error(`--${name} is needed`);
  }
  return values;
}

/** Starts Studio with these words in a folder, and waits for its address. */
function startStudio(offnominal, words, folder) {
  const program = spawn(resolve(offnominal), ["studio", ...words, "--no-open", "--json"], {
    cwd: folder,
    env: { ...process.env, TMPDIR: folder },
    stdio: ["ignore", "pipe", "inherit"],
  });
  const ended = new Promise((done) => program.on("exit", (code, signal) => done({ code, signal })));
  const address = new Promise((found, failed) => {
    let said = "";
    program.stdout.on("data", (data) => {
      said += data;
      const at = said.match(/"address": "([^"]+)"/);
      if (at) found(at[1]);
    });
    program.on("exit", () => failed(new Error("studio ended before it said its address")));
  });
  address.catch(() => {}); // who waits for it later hears of it
  return { program, ended, address };
}

/**
 * A page of Studio that asks nobody else and says nothing on its console but what `expected` has: words of messages
 * that belong to what is checked.
 */
export async function openPage(context, address, ready, expected, fault) {
  await context.route("**/*", (route) => {
    if (route.request().url().startsWith(address)) return route.continue();
    fault(`the page asks for ${route.request().url().slice(0, 200)}`);
    return route.abort();
  });
  const page = await context.newPage();
  page.setDefaultTimeout(Number(process.env.OFFNOMINAL_PAGE_TIMEOUT_MS ?? 120_000));
  page.on("pageerror", (error) => fault(`script error: ${error.message}`));
  // Chromium's own, of a picture that is read back for a screenshot.
  const known = [...expected, "GPU stall due to ReadPixels"];
  page.on("console", (message) => {
    const isKnown = known.some((words) => message.text().includes(words));
    if (["error", "warning"].includes(message.type()) && !isKnown) fault(`console: ${message.text()}`);
  });
  await page.goto(address);
  await page.waitForSelector(ready);
  // What the page's own module says of itself: `studio` in what a check runs inside the page.
  await page.evaluate(async () => {
    window.studio = await import(new URL("studio.js", document.baseURI).href);
  });
  return page;
}

/** The page in every width and colour: no wider than the window, accessible; and pictures of it where they are wanted. */
export async function look(page, looks, name, { screenshots, axeSource }, fault) {
  for (const [width, mode] of looks) {
    await page.setViewportSize({ width, height: 900 });
    await page.emulateMedia({ colorScheme: mode });
    await page.waitForTimeout(300);
    // A busy machine draws anew when it comes to it.
    const fits = () => document.documentElement.scrollWidth <= document.documentElement.clientWidth;
    await page.waitForFunction(fits, undefined, { timeout: 10_000 }).catch(() => undefined);
    // Tables that scroll are marked in the picture after the one that made them narrow.
    const marked = () => [...document.querySelectorAll(".scroll")].every((each) => each.scrollWidth <= each.clientWidth + 1 || each.hasAttribute("tabindex"));
    await page.waitForFunction(marked, undefined, { timeout: 10_000 }).catch(() => undefined);
    const inLook = (words) => fault(`${name}, ${mode}, ${width} pixels wide: ${words}`);
    if (screenshots) await page.screenshot({ path: join(screenshots, `${name}_${mode}_${width}.png`), fullPage: true });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
    if (wide > 0) inLook(`the page is ${wide} pixels wider than the window`);
    // axe needs a page whose policy lets its source in: it comes by the debugger, which is let in.
    await checkWithAxe(page, axeSource, inLook);
  }
}

/**
 * Runs `check({options, folder, start, newContext, axeSource}, fault)`, where start(words) starts Studio and gives its
 * address and its program. Ends all of it. Exit 0: all went well. Exit 1: one line per fault on stderr. Exit 2: it could
 * not be checked.
 */
export async function runCheck(name, options, check) {
  const faults = [];
  const fault = (text) => faults.push(text);
  try {
    await checkInBrowser(name, options(), check, fault);
    process.exitCode = faults.length === 0 ? 0 : 1;
  } catch (error) {
    faults.push(`${name}: ${error.message}`);
    process.exitCode = 2;
  }
  for (const text of new Set(faults)) console.error(text);
}

async function checkInBrowser(name, options, check, fault) {
  const { chromium } = createRequire(join(web, "package.json"))("playwright-core");
  const axeSource = await readAxe(web);
  const folder = await mkdtemp(join(tmpdir(), `offnominal-${name}-`));
  const started = [];
  let browser;
  try {
    browser = await chromium.launch({
      executablePath: options.chromium,
      args: ["--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run", "--disable-background-networking"],
    });
    const newContext = () => browser.newContext({ viewport: { width: 1280, height: 900 } });
    const start = async (words) => {
      const studio = startStudio(options.offnominal, words, folder);
      started.push(studio);
      return { address: await studio.address, program: studio.program, end: () => endStudio(studio, fault) };
    };
    await check({ options, folder, start, newContext, axeSource }, fault);
  } finally {
    await browser?.close();
    for (const studio of started) await endStudio(studio, fault);
    await rm(folder, { recursive: true, force: true });
  }
}

async function endStudio(studio, fault) {
  if (studio.isOver) return;
  studio.isOver = true;
  studio.program.kill("SIGINT");
  const { code, signal } = await studio.ended;
  if (code !== 0) fault(`Ctrl-C ends it with ${code ?? signal}`);
}

export async function checkNames(page, fault) {
  if (await page.evaluate(() => window.hacked !== undefined)) fault("a name was taken for markup");
}
