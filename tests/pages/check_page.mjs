// Opens a report page in headless Chromium with the network closed, light and dark, on a telephone, a desk and
// a wide screen, and checks what it shows, and that everybody can read it:
//   node check_page.mjs PAGE.html [--screenshots FOLDER] [--pdf OUT.pdf]
// Exit 0: the page is whole. Exit 1: one line per fault on stderr. Exit 2: it could not be checked.
import { createRequire } from "node:module";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { basename, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { parseArgs } from "node:util";
import {
  checkDrawings,
  checkKeyboard,
  checkLayout,
  checkPaper,
  checkWithAxe,
  readAxe,
} from "./accessible.mjs";

const kFlags = [
  "--headless",
  "--no-sandbox",
  "--disable-gpu",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];

/** One thing changes from look to look, and the open page follows. */
const kLooks = [
  [1280, "light"],
  [1280, "dark"],
  [2560, "dark"],
  [2560, "light"],
  [400, "light"],
  [400, "dark"],
];
const kNarrowest = 400;

const web = fileURLToPath(new URL("../../desk/web/", import.meta.url));

function readArguments() {
  const { values, positionals } = parseArgs({
    allowPositionals: true,
    options: {
      screenshots: { type: "string" },
      pdf: { type: "string" },
      chromium: { type: "string", default: process.env.OFFNOMINAL_CHROMIUM ?? "/usr/bin/chromium" },
    },
  });
  if (positionals.length !== 1) throw new Error("exactly one PAGE.html is needed");
  return { ...values, page: resolve(positionals[0]) };
}

function embeddedData(html) {
  const found = html.match(/<script type="application\/json" id="data">([\s\S]*?)<\/script>/);
  if (found === null) throw new Error("the page embeds no data");
  return JSON.parse(found[1]);
}

/** Reports every request but the page's own, and keeps it from leaving. */
async function closeNetwork(context, address, fault) {
  await context.route("**/*", (route) => {
    const asked = route.request().url();
    if (asked === address) return route.continue();
    fault(`the page asks for ${asked.slice(0, 200)}`);
    return route.abort();
  });
}

function listen(page, fault) {
  page.on("pageerror", (error) => fault(`script error: ${error.message}`));
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) fault(`console: ${message.text()}`);
  });
}

/** What stands on the page, as plain data. Runs inside the browser. */
function observe() {
  const ink = (canvas) => {
    if (canvas.width === 0 || canvas.height === 0) return 0;
    // A copy that is cheap to read.
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const drawn = copy.getContext("2d", { willReadFrequently: true });
    drawn.drawImage(canvas, 0, 0);
    const pixels = drawn.getImageData(0, 0, copy.width, copy.height).data;
    const colors = new Set();
    for (let i = 0; i < pixels.length; i += 4) {
      if (pixels[i + 3] > 0) colors.add((pixels[i] << 16) | (pixels[i + 1] << 8) | pixels[i + 2]);
    }
    return colors.size;
  };
  const textAt = (drawing, attribute) => {
    const ids = drawing?.getAttribute(attribute)?.split(" ") ?? [];
    return ids.map((id) => document.getElementById(id).textContent).join(" ");
  };
  const spokenOf = (drawing) => ({
    name: textAt(drawing, "aria-labelledby"),
    description: textAt(drawing, "aria-describedby"),
  });
  const blocks = {};
  for (const node of document.querySelectorAll("[data-block]")) {
    if (node.closest("[hidden]") !== null) continue; // of another recording
    const canvas = node.querySelector("canvas");
    const box = canvas?.getBoundingClientRect();
    blocks[node.dataset.block] = {
      rows: node.querySelectorAll("tbody tr").length,
      columns: node.querySelectorAll("thead th").length,
      figures: node.querySelectorAll("dt").length,
      title: node.querySelector("h3, caption")?.textContent ?? "",
      ...spokenOf(node.querySelector(".drawing")),
      legend: [...node.querySelectorAll(".legend button")].map(
        (each) => each.querySelector("span").textContent,
      ),
      text: node.textContent,
      width: box?.width ?? 0,
      height: box?.height ?? 0,
      colors: canvas ? ink(canvas) : 0,
    };
  }
  return {
    title: document.title,
    heading: document.querySelector("h1")?.textContent,
    verdict: document.getElementById("verdict-words")?.textContent,
    headings: [...document.querySelectorAll("h2")].map((node) => node.textContent),
    recording: document.getElementById("recording")?.value ?? "",
    recordings: [...(document.getElementById("recording")?.options ?? [])].map((each) => each.value),
    footer: document.querySelector("footer")?.textContent ?? "",
    blocks,
    overflow: document.documentElement.scrollWidth - document.documentElement.clientWidth,
  };
}

function checkBlock(block, seen, place, fault) {
  const where = `block ${place} (${block.type} "${block.title ?? block.caption ?? ""}")`;
  if (seen === undefined) return fault(`${where} is missing`);
  const expect = (what, found, wanted) => {
    if (found !== wanted) fault(`${where}: ${what} is ${found}, ${wanted} in the data`);
  };
  if (block.type === "table") {
    expect("number of rows", seen.rows, block.rows.length);
    expect("number of columns", seen.columns, block.columns.length);
    expect("caption", seen.title, block.caption);
  } else if (block.type === "key_figures") {
    expect("number of figures", seen.figures, block.figures.length);
  } else if (block.type === "note") {
    // What stands between two backticks is shown as code.
    const first = block.text.split("\n")[0];
    const plain = first.split("`").length % 2 === 1 ? first.replaceAll("`", "") : first;
    if (!seen.text.includes(plain)) fault(`${where}: its text is missing`);
  } else {
    expect("title", seen.title, block.title);
    expect("name for screen readers", seen.name, block.title);
    if (seen.description === "") fault(`${where}: no description for screen readers`);
    if (seen.rows === 0) fault(`${where}: no numbers in place of the picture`);
    if (seen.width < 200 || seen.height < 60) {
      fault(`${where}: drawn ${seen.width} x ${seen.height} pixels`);
    }
    if (seen.colors < 4) fault(`${where}: the picture is blank`);
  }
  if (block.type === "chart") {
    expect("legend", seen.legend.join("|"), block.series.map((each) => each.name).join("|"));
  }
}

function checkPage(data, seen, fault) {
  const expect = (what, found, wanted) => {
    if (found !== wanted) fault(`${what} is "${found}", "${wanted}" in the data`);
  };
  expect("title", seen.title, data.title);
  expect("heading", seen.heading, data.title);
  expect("verdict", seen.verdict, data.verdict.words);
  expect("sections", seen.headings.join("|"), data.sections.map((each) => each.heading).join("|"));
  if (!seen.footer.includes(`offnominal ${data.version}, diagnostic aid, claims no SIL/PL`)) {
    fault("the footer does not say what the page is");
  }
  if (seen.overflow > 0) fault(`the page is ${seen.overflow} pixels wider than the window`);
  let blocks = 0;
  const named = data.sections.map((each) => each.recording).filter((name) => name !== "");
  expect("recordings to choose from", seen.recordings.join("|"), [...new Set(named)].join("|"));
  data.sections.forEach((section, at) => {
    if (![seen.recording, ""].includes(section.recording)) return;
    section.blocks.forEach((block, i) => {
      checkBlock(block, seen.blocks[`${at}.${i}`], `${at}.${i}`, fault);
      ++blocks;
    });
  });
  expect("number of blocks", Object.keys(seen.blocks).length, blocks);
  return blocks;
}

/** From the last to the first, which is the one that the page opens with. */
function recordings(data) {
  const names = data.sections.map((each) => each.recording).filter((name) => name !== "");
  return [...new Set(names)].reverse();
}

/** After the page has answered a change of its window. Runs inside the browser. */
function settled() {
  return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done())));
}

/** Zooms the charts by their API, as a reader would, so that a fault in redrawing shows. */
async function exercise(page) {
  await page.evaluate(() => {
    const drawings = [...document.querySelectorAll(".drawing")];
    const shown = drawings.filter((host) => host.closest("[hidden]") === null).map(({ figure }) => figure);
    const groups = shown.map(({ block }) => block.zoom_group || block);
    // The others of a group follow their first.
    const zoomed = shown.filter(
      ({ kind }, index) => kind.cursor !== null && groups.indexOf(groups[index]) === index,
    );
    for (const figure of zoomed) {
      figure.chart.dispatchAction({ type: "dataZoom", dataZoomIndex: 0, start: 40, end: 60 });
    }
    for (const button of document.querySelectorAll(".legend button")) {
      button.click();
      button.click();
    }
    for (const { chart } of zoomed) {
      const batch = chart.getOption().dataZoom.map((_, dataZoomIndex) => ({ dataZoomIndex, start: 0, end: 100 }));
      chart.dispatchAction({ type: "dataZoom", batch });
    }
  });
}

/** The page as it stands, in its present width and colours. */
async function checkLook(page, data, options, [width, mode], axeSource, fault) {
  const inLook = (words) => fault(`${mode}, ${width} pixels wide: ${words}`);
  const blocks = checkPage(data, await page.evaluate(observe), inLook);
  if (options.screenshots) {
    const name = `${basename(options.page, ".html")}_${mode}_${width}.png`;
    await page.screenshot({ path: join(options.screenshots, name), fullPage: true });
  }
  await checkDrawings(page, inLook);
  await checkWithAxe(page, axeSource, inLook);
  await checkLayout(page, inLook);
  return blocks;
}

async function check(options, fault) {
  const { chromium } = createRequire(join(web, "package.json"))("playwright-core");
  const html = await readFile(options.page, "utf8");
  if (html.includes("axe-core")) fault("the page holds what only its tests need");
  const data = embeddedData(html);
  const axeSource = await readAxe(web);
  const profile = await mkdtemp(join(tmpdir(), "offnominal-page-"));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: options.chromium,
    args: kFlags,
    offline: true,
  });
  try {
    await closeNetwork(context, pathToFileURL(options.page).href, fault);
    context.setDefaultTimeout(180_000); // a machine that is busy draws slowly
    const page = await context.newPage();
    listen(page, fault);
    const look = async (width, mode) => {
      await page.setViewportSize({ width, height: 900 });
      await page.emulateMedia({ colorScheme: mode });
      await page.evaluate(settled);
    };
    await look(...kLooks[0]);
    await page.goto(pathToFileURL(options.page).href, { waitUntil: "load" });
    let blocks = 0;
    for (const [width, mode] of kLooks) {
      await look(width, mode);
      blocks = await checkLook(page, data, options, [width, mode], axeSource, fault);
      // Where tables scroll, they are stops of the Tab key, too.
      if (width === kNarrowest && mode === "light") await checkKeyboard(page, fault);
    }
    for (const name of recordings(data)) {
      await page.selectOption("#recording", name);
      await page.evaluate(settled);
      const inRecording = (words) => fault(`recording ${name}: ${words}`);
      checkPage(data, await page.evaluate(observe), inRecording);
      await checkDrawings(page, inRecording);
      await checkLayout(page, inRecording);
    }
    await exercise(page).catch((error) => fault(`zooming and hiding: ${error.message}`));
    await checkPaper(page, axeSource, fault);
    if (options.pdf) await page.pdf({ path: options.pdf, format: "A4" });
    return blocks;
  } finally {
    await context.close();
    await rm(profile, { recursive: true, force: true });
  }
}

const faults = [];
try {
  const options = readArguments();
  const blocks = await check(options, (text) => faults.push(text));
  for (const text of new Set(faults)) console.error(`${options.page}: ${text}`);
  if (faults.length === 0) console.log(`${options.page}: ${blocks} blocks drawn, no request`);
  process.exitCode = faults.length === 0 ? 0 : 1;
} catch (error) {
  console.error(`check_page: ${error.message}`);
  process.exitCode = 2;
}
