// Pictures of documents: ECharts on the server's side, in the look of the report pages, as SVG files that are small
// and the same for the same numbers.
import { writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const web = fileURLToPath(new URL("../../desk/web/", import.meta.url));
const require = createRequire(join(web, "package.json"));
const echarts = require("echarts");

/** The colours and letters of report pages: desk/web/report/palette.ts. */
async function pagesPalette() {
  const options = { entryPoints: [join(web, "report/palette.ts")], bundle: true, format: "esm", write: false };
  const [{ text }] = require("esbuild").buildSync(options).outputFiles;
  return import(`data:text/javascript,${encodeURIComponent(text)}`);
}

const { kLightLook, kFontFamily } = await pagesPalette();
export const kLook = kLightLook;

export const kWidth = 720;

export function axis(look = {}) {
  return {
    type: "value",
    axisLine: { show: true, onZero: false, lineStyle: { color: kLook.axis } },
    axisTick: { show: true, lineStyle: { color: kLook.axis } },
    axisLabel: { color: kLook.soft, fontSize: 12 },
    splitLine: { show: true, lineStyle: { color: kLook.rule } },
    nameTextStyle: { color: kLook.ink, fontSize: 12.5 },
    ...look,
  };
}

/** Words at a place of the picture, px; `style` as ECharts' graphic text has it. */
export function words(text, x, y, style = {}) {
  const { size = 12.5, weight = "normal", align = "left", color = kLook.ink } = style;
  return {
    type: "text",
    x,
    y,
    silent: true,
    style: { text, fill: color, font: `${weight} ${size}px ${kFontFamily}`, align, verticalAlign: "middle" },
  };
}

export function stroke(from, to, color, { width = 1.2, dashed = false } = {}) {
  return {
    type: "line",
    silent: true,
    shape: { x1: from[0], y1: from[1], x2: to[0], y2: to[1] },
    style: { stroke: color, lineWidth: width, lineDash: dashed ? [5, 4] : null },
  };
}

/** A legend in a row from `x` on: {name, color, kind: "line", "dashed" or "points", thick}, `width` px for each. */
export function legend(entries, x, y) {
  let at = x;
  return entries.flatMap(({ name, color, kind, width, thick = 2.2 }) => {
    const sample =
      kind === "points"
        ? { type: "circle", silent: true, shape: { cx: at + 11, cy: y, r: 3.5 }, style: { fill: color } }
        : stroke([at, y], [at + 22, y], color, { width: thick, dashed: kind === "dashed" });
    const drawn = [sample, words(name, at + 28, y)];
    at += width;
    return drawn;
  });
}

/** Points as one shape: a thousand circles would be a large file. */
export function pointsSeries(points, color, look = {}) {
  const { size = 3, ...more } = look;
  return {
    type: "custom",
    silent: true,
    data: points,
    encode: { x: 0, y: 1 },
    renderItem: (params, api) => {
      if (params.dataIndexInside !== 0) return null;
      const squares = points.map((point) => {
        const [x, y] = api.coord(point).map((pixel) => (pixel - size / 2).toFixed(1));
        return `M${x} ${y}h${size}v${size}h-${size}z`;
      });
      return { type: "path", shape: { pathData: squares.join("") }, style: { fill: color, opacity: 0.75 } };
    },
    ...more,
  };
}

export function lineSeries(points, color, look = {}) {
  const { width = 1.5, dashed = false, ...more } = look;
  return {
    type: "line",
    silent: true,
    data: points,
    showSymbol: false,
    lineStyle: { color, width, type: dashed ? [5, 3] : "solid", join: "round" },
    ...more,
  };
}

function rounded(attribute) {
  return attribute.replace(/\d+\.\d{2,}/g, (number) => String(Number(Number(number).toFixed(1))));
}

function escaped(text) {
  return text.replaceAll("&", "&amp;").replaceAll("<", "&lt;");
}

/** Draws ECharts' `option` into `file`, with a title for those who hear the picture. */
export function save(file, { title, height, ...option }) {
  const chart = echarts.init(null, null, { renderer: "svg", ssr: true, width: kWidth, height });
  chart.setOption({
    animation: false,
    backgroundColor: kLook.surface,
    textStyle: { fontFamily: kFontFamily },
    ...option,
  });
  const drawn = chart.renderToSVGString();
  chart.dispose();
  // A tenth of a pixel is fine enough. The letters are said once. Nothing here follows a pointer.
  const svg = drawn
    .replaceAll(kFontFamily, "FAMILY")
    .replace(/ style="font: (\w+) ([\d.]+)px FAMILY"/g, ' font-weight="$1" font-size="$2"')
    .replace(/ style="font-size:([\d.]+)px;font-family:FAMILY;"/g, ' font-size="$1"')
    .replace(/<style[^]*?<\/style>/g, "")
    .replace(/ (class|ecmeta_\w+|pointer-events|xml:space)="[^"]*"| font-weight="normal"/g, "")
    .replace(/ (d|transform|x|y)="[^"]*"/g, rounded)
    .replace(/^<svg/, `<svg role="img" font-family='${kFontFamily}'`)
    .replace(/^<svg[^>]*>/, (tag) => `${tag}\n<title>${escaped(title)}</title>`);
  if (svg.includes("FAMILY")) throw new Error(`${file}: letters that are said in a way that is not known here`);
  writeFileSync(file, `${svg.trim()}\n`);
  process.stdout.write(`${file}: ${Math.round(svg.length / 1024)} kB\n`);
}
