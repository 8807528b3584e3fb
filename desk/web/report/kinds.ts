import { chartHeight, chartOption } from "./chart";
import { chartCsv, chartNumbers, chartWords } from "./chart_words";
import { chartCursor, heatmapCursor } from "./cursors";
import type { Chart, Drawn, Heatmap, Waterfall } from "./document";
import type { Kind } from "./figure_type";
import { heatmapCsv, heatmapHeight, heatmapNumbers, heatmapOption, heatmapWords } from "./heatmap";
import { waterfallCsv, waterfallHeight, waterfallNumbers, waterfallOption, waterfallWords } from "./waterfall";

const kKinds: { chart: Kind<Chart>; heatmap: Kind<Heatmap>; waterfall: Kind<Waterfall> } = {
  chart: {
    option: chartOption,
    height: chartHeight,
    csv: chartCsv,
    words: chartWords,
    numbers: chartNumbers,
    cursor: chartCursor,
  },
  heatmap: {
    option: heatmapOption,
    height: heatmapHeight,
    csv: heatmapCsv,
    words: heatmapWords,
    numbers: heatmapNumbers,
    cursor: heatmapCursor,
  },
  waterfall: {
    option: waterfallOption,
    height: waterfallHeight,
    csv: waterfallCsv,
    words: waterfallWords,
    numbers: waterfallNumbers,
    cursor: null,
  },
};

export function kindOf(block: Drawn): Kind<Drawn> {
  return kKinds[block.type];
}
