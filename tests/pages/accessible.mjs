// Whether a report page can be read and used by everybody: axe-core's rules, the contrast and the place
// of what is drawn on a canvas, which axe does not see, the keyboard, and paper.
import { createRequire } from "node:module";
import { readFile } from "node:fs/promises";
import { join } from "node:path";

/** Rules that axe leaves out unless asked. */
const kFurtherRules = ["target-size", "label-content-name-mismatch", "focus-order-semantics"];

export async function readAxe(web) {
  return readFile(createRequire(join(web, "package.json")).resolve("axe-core/axe.min.js"), "utf8");
}

/**
 * All of the page, what is folded up, too; from its top, where nothing lies below the bar that stays in
 * sight: what is half below it is scrolled out, not too small.
 */
export async function checkWithAxe(page, axeSource, fault) {
  await page.evaluate(() => {
    for (const details of document.querySelectorAll("details")) details.open = true;
    window.scrollTo({ top: 0, behavior: "instant" });
  });
  if (await page.evaluate(() => typeof axe === "undefined")) await page.evaluate(axeSource);
  const found = await page.evaluate(
    (further) => {
      const rules = Object.fromEntries(further.map((name) => [name, { enabled: true }]));
      return axe.run(document, { rules, resultTypes: ["violations"] });
    },
    kFurtherRules,
  );
  if (found.passes.length < 10) fault(`axe has looked at ${found.passes.length} rules only`);
  for (const { id, help, nodes } of found.violations) {
    const [first] = nodes;
    const why = first.failureSummary.split("\n").slice(1, 2).join("").trim();
    fault(`axe, ${id} (${help}), ${nodes.length} times, first ${first.html.slice(0, 160)}: ${why}`);
  }
}

/**
 * Faults of what is drawn: text below 4.5:1, a shape of a chart below 3:1 against what is behind it
 * (WCAG leaves out the colours of a map, which are its content), a label that is cut off or that another
 * one covers. Runs inside the browser.
 */
function drawingFaults() {
  const probe = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
  probe.canvas.width = probe.canvas.height = 1;
  const over = (color, opacity, below) => {
    const paint = (style, alpha) => {
      probe.globalAlpha = alpha;
      probe.fillStyle = style;
      probe.fillRect(0, 0, 1, 1);
    };
    paint(below, 1);
    paint(color, opacity);
    const [r, g, b] = probe.getImageData(0, 0, 1, 1).data;
    return `rgb(${r},${g},${b})`;
  };
  const luminance = (color) => {
    const [r, g, b] = color.match(/\d+/g).map((channel) => {
      const share = channel / 255;
      return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
    });
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const contrast = (a, b) => {
    const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y);
    return (high + 0.05) / (low + 0.05);
  };
  const boxOf = (shape) => {
    const box = shape.getBoundingRect().clone();
    if (shape.transform) box.applyTransform(shape.transform);
    return box;
  };
  const right = (box) => box.x + box.width;
  const bottom = (box) => box.y + box.height;
  const overlap = (a, b) =>
    Math.min(right(a), right(b)) - Math.max(a.x, b.x) > 2 &&
    Math.min(bottom(a), bottom(b)) - Math.max(a.y, b.y) > 2;
  /** A copy that is cheap to read. */
  const copyOf = (canvas) => {
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const context = copy.getContext("2d", { willReadFrequently: true });
    context.drawImage(canvas, 0, 0);
    return context;
  };
  /** The colour seen most about a label. */
  const behind = (drawn, ratio, box, surface) => {
    const [x, y, width, height] = [box.x - 3, box.y - 3, box.width + 6, box.height + 6].map(
      (length) => Math.round(length * ratio),
    );
    const pixels = drawn.getImageData(x, y, width, height).data;
    const seen = new Map();
    for (let i = 0; i < pixels.length; i += 4) {
      const color = pixels.slice(i, i + 4).join();
      seen.set(color, (seen.get(color) ?? 0) + 1);
    }
    const [most] = [...seen].reduce((a, b) => (b[1] > a[1] ? b : a));
    const [r, g, b, opacity] = most.split(",");
    return over(`rgb(${r},${g},${b})`, opacity / 255, surface);
  };
  const faults = [];
  const drawings = [...document.querySelectorAll(".drawing")].filter((host) => host.closest("[hidden]") === null);
  for (const { block, chart, host, option } of drawings.map(({ figure }) => figure)) {
    const canvas = host.querySelector("canvas");
    const drawn = copyOf(canvas);
    const ratio = canvas.width / canvas.clientWidth;
    const surface = over(getComputedStyle(host.closest(".card")).backgroundColor, 1, "white");
    const fault = (words) => faults.push(`${block.type} "${block.title}": ${words}`);
    const [width, height] = [host.clientWidth, host.clientHeight];
    const shapes = chart
      .getZr()
      .storage.getDisplayList(true)
      .filter((shape) => !shape.ignore && !shape.invisible)
      .map((shape) => ({ shape, style: shape.style, box: boxOf(shape) }))
      .filter(({ box }) => box.x + box.width > 0 && box.y + box.height > 0);
    const labels = shapes.filter(({ style }) => style.text);
    for (const { style, box } of labels) {
      const below = style.stroke ? over(style.stroke, 1, surface) : behind(drawn, ratio, box, surface);
      const found = contrast(over(style.fill, style.opacity ?? 1, below), below);
      if (found < 4.5) fault(`the label "${style.text}" has a contrast of ${found.toFixed(2)}`);
      const inside = box.x >= -1 && box.y >= -1 && right(box) <= width + 1 && bottom(box) <= height + 1;
      if (!inside) fault(`the label "${style.text}" is cut off`);
    }
    labels.forEach((one, index) => {
      for (const other of labels.slice(index + 1)) {
        if (overlap(one.box, other.box)) {
          fault(`the labels "${one.style.text}" and "${other.style.text}" overlap`);
        }
      }
    });
    if (block.type === "heatmap") continue;
    const { grid } = option;
    const plot = { x: grid.left, y: grid.top };
    plot.width = width - grid.right - grid.left;
    plot.height = height - grid.bottom - grid.top;
    const seen = new Set();
    for (const { style, box } of shapes) {
      if (style.text || style.stroke === option.xAxis.splitLine.lineStyle.color) continue;
      const beside = box.x > right(plot) || right(box) < plot.x;
      if (beside || box.y > bottom(plot) || bottom(box) < plot.y) continue;
      const paints = [style.fill, style.lineWidth > 0 ? style.stroke : null]
        .filter((paint) => typeof paint === "string" && !["none", "transparent"].includes(paint))
        .map((paint) => over(paint, style.opacity ?? 1, surface));
      const key = paints.join();
      if (paints.length === 0 || seen.has(key)) continue;
      seen.add(key);
      const found = Math.max(...paints.map((paint) => contrast(paint, surface)));
      if (found < 3) fault(`a shape drawn in ${key} has a contrast of ${found.toFixed(2)}`);
    }
  }
  return faults;
}

export async function checkDrawings(page, fault) {
  for (const words of await page.evaluate(drawingFaults)) fault(words);
}

/** Faults of what stands beside the pictures. Runs inside the browser. */
function layoutFaults() {
  const faults = [];
  const shown = (node) => node.checkVisibility({ visibilityProperty: true });
  for (const node of document.querySelectorAll("body *")) {
    const { overflowX } = getComputedStyle(node);
    if (overflowX === "visible" || node.matches(".hidden-text") || !shown(node)) continue;
    if (node.scrollWidth <= node.clientWidth + 1) continue;
    const hint = node.previousElementSibling;
    const words = node.textContent.slice(0, 60);
    if (!(node.tabIndex === 0 && hint?.matches(".scroll-hint") && shown(hint))) {
      faults.push(`"${words}" is cut off without a hint`);
    }
  }
  const names = new Map();
  for (const control of document.querySelectorAll("button, summary")) {
    if (control.closest("[hidden]") !== null) continue; // of another recording
    names.set(control.textContent, (names.get(control.textContent) ?? 0) + 1);
  }
  for (const [name, times] of names) {
    if (times > 1) faults.push(`${times} controls are called "${name}"`);
  }
  return faults;
}

export async function checkLayout(page, fault) {
  for (const words of await page.evaluate(layoutFaults)) fault(words);
}

/** Goes through the page by Tab, without a mouse, and uses one chart of each sort that it meets. */
export async function checkKeyboard(page, fault) {
  const wanted = await page.evaluate(() => {
    const kStops = "a[href], button, select, summary, [tabindex='0'], [role=application]";
    const shown = [...document.querySelectorAll(kStops)].filter((node) => node.checkVisibility({ visibilityProperty: true }));
    shown.forEach((node, index) => (node.dataset.stop = index));
    document.activeElement.blur();
    return shown.map((node) => node.outerHTML.slice(0, 120));
  });
  const reached = new Set();
  const used = new Set();
  for (let i = 0; i < wanted.length; ++i) {
    await page.keyboard.press("Tab");
    const stop = await page.evaluate(focused);
    if (stop === null) break;
    reached.add(stop.at);
    if (stop.at !== i) fault(`Tab comes to ${wanted[stop.at]} where ${wanted[i]} stands`);
    if (stop.outline === "none") fault(`the focus is not seen on ${wanted[i]}`);
    if (stop.chart !== null && !used.has(stop.chart)) await useChart(page, fault);
    used.add(stop.chart);
  }
  wanted.forEach((words, index) => {
    if (!reached.has(index)) fault(`Tab never comes to ${words}`);
  });
}

/** Which stop has the focus, and which sort of chart it is. Runs inside the browser. */
function focused() {
  const node = document.activeElement;
  if (node.dataset.stop === undefined) return null;
  const { figure } = node;
  const chart = figure ? `${figure.block.type} ${figure.option.tooltip.trigger}` : null;
  return { at: Number(node.dataset.stop), outline: getComputedStyle(node).outlineStyle, chart };
}

/** What a focused chart shows, says and has zoomed to. */
async function chartState(page) {
  return page.evaluate(() => {
    const host = document.activeElement;
    const { figure } = host;
    const { start, end } = figure.chart.getOption().dataZoom[0];
    const tip = host.querySelector(".tip");
    const tipShown = tip?.style.opacity !== "0" && tip?.checkVisibility({ visibilityProperty: true });
    return {
      title: figure.block.title,
      share: end - start,
      start,
      tip: tipShown === true,
      hint: host.parentElement.querySelector(".keys")?.checkVisibility() ?? false,
      said: document.getElementById("spoken").textContent,
    };
  });
}

/** The library hides a tip after a delay, which a busy machine makes longer. */
async function hidesTip(page) {
  const kTries = 50;
  for (let i = 0; i < kTries; ++i) {
    if (!(await chartState(page)).tip) return true;
    await page.waitForTimeout(100);
  }
  return false;
}

async function useChart(page, fault) {
  const press = async (key) => {
    await page.keyboard.press(key);
    return chartState(page);
  };
  const first = await press("ArrowRight");
  const expect = (holds, what) => holds || fault(`keys on the chart "${first.title}": ${what}`);
  expect(first.hint, "no hint is shown");
  expect(first.tip && first.said.length > 3, `an arrow shows no values, it says "${first.said}"`);
  const second = await press("ArrowLeft");
  expect(second.said !== first.said, `the other arrow says "${second.said}" again`);
  const zoomed = await press("+");
  expect(zoomed.share < 60, "+ does not zoom");
  expect((await press("Shift+ArrowRight")).start > zoomed.start, "shift and an arrow does not move");
  expect((await press("-")).share > zoomed.share, "- does not zoom out");
  const whole = await press("0");
  expect(whole.share === 100, "0 does not show all");
  expect(await hidesTip(page), "zooming leaves the values of another place");
}

/** Paper is white whatever the screen is, and as wide as A4 between its margins. */
export async function checkPaper(page, axeSource, fault) {
  const kPaperWidth = 688;
  await page.emulateMedia({ media: "print", colorScheme: "dark" });
  await page.setViewportSize({ width: kPaperWidth, height: 1000 });
  await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
  const onPaper = (words) => fault(`on paper: ${words}`);
  await checkWithAxe(page, axeSource, onPaper);
  await checkDrawings(page, onPaper);
  const { ground, beyond } = await page.evaluate(() => ({
    ground: getComputedStyle(document.querySelector(".card, .verdict")).backgroundColor,
    beyond: document.documentElement.scrollWidth - document.documentElement.clientWidth,
  }));
  if (ground !== "rgb(255, 255, 255)") onPaper(`the ground is ${ground}`);
  if (beyond > 0) onPaper(`the page is ${beyond} pixels wider than the paper`);
  await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
  await page.emulateMedia({ media: null });
}
