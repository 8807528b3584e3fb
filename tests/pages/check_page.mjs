// Opens a report page in headless Chromium with the network closed and checks what it shows:
//   node check_page.mjs PAGE.html [--screenshot OUT.png] [--dark] [--width 1280] [--pdf OUT.pdf]
// Exit 0: the page is whole. Exit 1: one line per fault on stderr. Exit 2: it could not be checked.
import { createRequire } from "node:module";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { parseArgs } from "node:util";

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

const web = fileURLToPath(new URL("../../tools/report/web/", import.meta.url));

function readArguments() {
  const { values, positionals } = parseArgs({
    allowPositionals: true,
    options: {
      screenshot: { type: "string" },
      pdf: { type: "string" },
      dark: { type: "boolean", default: false },
      width: { type: "string", default: "1280" },
      chromium: { type: "string", default: process.env.OFFNOMINAL_CHROMIUM ?? "/usr/bin/chromium" },
    },
  });
  if (positionals.length !== 1) throw new Error("exactly one PAGE.html is needed");
  return { ...values, page: resolve(positionals[0]), width: Number(values.width) };
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
    const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    const colors = new Set();
    for (let i = 0; i < pixels.length; i += 4) {
      if (pixels[i + 3] > 0) colors.add((pixels[i] << 16) | (pixels[i + 1] << 8) | pixels[i + 2]);
    }
    return colors.size;
  };
  const blocks = {};
  for (const node of document.querySelectorAll("[data-block]")) {
    const canvas = node.querySelector("canvas");
    const box = canvas?.getBoundingClientRect();
    blocks[node.dataset.block] = {
      rows: node.querySelectorAll("tbody tr").length,
      columns: node.querySelectorAll("thead th").length,
      figures: node.querySelectorAll("dt").length,
      title: node.querySelector("h3, caption")?.textContent ?? "",
      label: node.querySelector("[role=img]")?.getAttribute("aria-label") ?? "",
      legend: [...node.querySelectorAll(".legend button")].map((each) => each.textContent),
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
    if (!seen.text.includes(block.text.split("\n")[0])) fault(`${where}: its text is missing`);
  } else {
    expect("title", seen.title, block.title);
    if (seen.label === "") fault(`${where}: no label for screen readers`);
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
  data.sections.forEach((section, at) =>
    section.blocks.forEach((block, i) => {
      checkBlock(block, seen.blocks[`${at}.${i}`], `${at}.${i}`, fault);
      ++blocks;
    }),
  );
  expect("number of blocks", Object.keys(seen.blocks).length, blocks);
  return blocks;
}

/** Zooms every chart by its API, as a reader would, so that a fault in redrawing shows. */
async function exercise(page) {
  await page.evaluate(() => {
    for (const figure of figures.filter((each) => each.kind.zooms)) {
      figure.chart.dispatchAction({ type: "dataZoom", dataZoomIndex: 0, start: 40, end: 60 });
    }
    for (const button of document.querySelectorAll(".legend button")) {
      button.click();
      button.click();
    }
    for (const figure of figures.filter((each) => each.kind.zooms)) resetZoom(figure);
  });
}

async function check(options, fault) {
  const { chromium } = createRequire(join(web, "package.json"))("playwright-core");
  const data = embeddedData(await readFile(options.page, "utf8"));
  const profile = await mkdtemp(join(tmpdir(), "offnominal-page-"));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: options.chromium,
    args: kFlags,
    viewport: { width: options.width, height: 900 },
    colorScheme: options.dark ? "dark" : "light",
    offline: true,
  });
  try {
    const address = pathToFileURL(options.page).href;
    await closeNetwork(context, address, fault);
    const page = await context.newPage();
    listen(page, fault);
    await page.goto(address, { waitUntil: "load" });
    const blocks = checkPage(data, await page.evaluate(observe), fault);
    if (options.screenshot) await page.screenshot({ path: options.screenshot, fullPage: true });
    if (options.pdf) await page.pdf({ path: options.pdf, format: "A4" });
    await exercise(page).catch((error) => fault(`zooming and hiding: ${error.message}`));
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
