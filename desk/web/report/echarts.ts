import { CustomChart, LineChart, ScatterChart } from "echarts/charts";
import {
  DataZoomComponent,
  GraphicComponent,
  GridComponent,
  LegendPlainComponent,
  ToolboxComponent,
  TooltipComponent,
  VisualMapContinuousComponent,
} from "echarts/components";
import { connect, init, use, type ECharts, type EChartsCoreOption } from "echarts/core";
import { CanvasRenderer } from "echarts/renderers";

// What the figures are made of and no more: it halves a page.
use([
  CanvasRenderer,
  CustomChart,
  DataZoomComponent,
  GraphicComponent,
  GridComponent,
  LegendPlainComponent,
  LineChart,
  ScatterChart,
  ToolboxComponent,
  TooltipComponent,
  VisualMapContinuousComponent,
]);

export { connect, init };
export type { ECharts };
export type Option = EChartsCoreOption;

/** What a custom series' renderItem() is given: the item, and where the plot is. */
export interface ItemParams {
  dataIndex: number;
  dataIndexInside: number;
  dataInsideLength: number;
  coordSys: { x: number; y: number; width: number; height: number };
}

export interface ItemApi {
  value(dimension: number, index?: number): number;
  coord(place: readonly number[]): [number, number];
  visual(key: "color"): string;
}
