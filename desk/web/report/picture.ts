import { element, penOf } from "./element";
import { chartOf, type Figure } from "./figure_type";
import { scaleWords } from "./heatmap";
import { currentLook } from "./look";
import { kFontFamily, seriesColors } from "./palette";

export function fileName(figure: Figure, extension: string) {
  const words = figure.block.title.toLowerCase().replace(/[^a-z0-9]+/g, "-");
  return `${words.replace(/^-|-$/g, "") || "figure"}.${extension}`;
}

export function saveAs(address: string, name: string) {
  const link = element("a", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
}

/** The picture with its title and legend, which the page shows outside the canvas. */
export function savePicture(figure: Figure) {
  const look = currentLook();
  const ratio = 2;
  const drawing = chartOf(figure).renderToCanvas({ pixelRatio: ratio, backgroundColor: look.surface });
  const head = 62 * ratio;
  const canvas = element("canvas", { width: String(drawing.width), height: String(drawing.height + head) });
  const context = penOf(canvas);
  context.fillStyle = look.surface;
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(drawing, 0, head);
  context.scale(ratio, ratio);
  context.fillStyle = look.ink;
  context.font = `600 15px ${kFontFamily}`;
  context.fillText(figure.block.title, 8, 24);
  context.font = `13px ${kFontFamily}`;
  if (figure.block.type === "heatmap") {
    context.fillStyle = look.soft;
    context.fillText(scaleWords(figure.block), 8, 46);
  }
  if (figure.block.type === "chart") {
    const colors = seriesColors(figure.block.series, look);
    let x = 8;
    figure.block.series.forEach((series, index) => {
      if (figure.hidden.has(series.name)) return;
      context.fillStyle = colors[index] ?? look.ink;
      context.fillRect(x, 40, 18, series.kind === "line" || series.kind === "steps" ? 2.5 : 7);
      context.fillStyle = look.ink;
      context.fillText(series.name, x + 24, 46);
      x += 44 + context.measureText(series.name).width;
    });
  }
  saveAs(canvas.toDataURL("image/png"), fileName(figure, "png"));
}
