import type { Cell, Column, Drawn, Series } from "./document";
import type { ECharts, Option } from "./echarts";
import type { Look } from "./palette";

export interface Extent {
  low: number;
  high: number;
}

/** Two ends, or a place in the picture: x, y. */
export type Pair = readonly [number, number];
/** Steps to the right and up. */
export type Arrow = readonly [number, number];

/** A point or a bar. */
export interface ItemPlace {
  series: Series;
  index: number;
  at: number;
  x: number;
}

/** x, y, value, column, row: the middle of a cell. */
export type CellValue = [number, number, number, number, number];

export interface CellPlace {
  value: CellValue;
  x: number;
  y: number;
  column: number;
  row: number;
}

/** Where a tip is shown; `tooltip`: one of its own. */
export interface Tip {
  x: number;
  y: number;
  tooltip?: { formatter: () => string };
}

interface FigureOption extends Option {
  grid: { left: number; right: number; top: number; bottom: number };
}

/** What a figure of this kind of block draws, saves and says. A kind with a cursor can be zoomed, too. */
export interface Kind<B extends Drawn> {
  option(block: B, look: Look, width: number, extent: Extent | null, isShown: (name: string) => boolean): FigureOption;
  height(block: B): number;
  csv(block: B): string;
  words(block: B): string;
  numbers(block: B): { columns: Column[]; rows: Cell[][] };
  cursor: ((figure: Figure, arrow: Arrow) => Tip | null) | null;
}

/** A figure on the page; chart and option are null until it is drawn. */
export interface Figure {
  block: Drawn;
  kind: Kind<Drawn>;
  host: FigureHost;
  place: string;
  chart: ECharts | null;
  extent: Extent | null;
  legend: HTMLElement | null;
  /** Names of the series that the reader has switched off. */
  hidden: Set<string>;
  /** Where the keyboard is: in pixels along the lines, at an item or at a cell. */
  cursor: number | ItemPlace | CellPlace | null;
  option: FigureOption | null;
  /** The labels of the axes' ends as they were last set. */
  edges?: string;
  /** The lines of the cursors in time; of Studio's charts over time. */
  cursorLines?: HTMLElement;
}

/** The place of the drawing, which knows its figure: whoever has the element has both. */
export interface FigureHost extends HTMLElement {
  figure?: Figure;
}

export function chartOf({ chart }: Figure): ECharts {
  if (chart === null) throw new Error("the figure is not drawn yet");
  return chart;
}
