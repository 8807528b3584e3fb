/** A report page as the data that it embeds: desk/report/page.hpp says what each part means. A gap is null. */

export type Level = "neutral" | "good" | "warn" | "bad";
type Width = "full" | "half";
export type Value = number | null;
export type Cell = number | string | null;

export interface Axis {
  name: string;
  unit: string;
  log: boolean;
  min: Value;
  max: Value;
}

export interface Column {
  name: string;
  unit: string;
  format: string;
}

/** What a table is made of, on a report page and elsewhere. */
export interface Grid {
  caption: string;
  columns: Column[];
  rows: Cell[][];
}

export interface Table extends Grid {
  type: "table";
  note: string;
}

export interface KeyFigure {
  label: string;
  value: Cell;
  unit: string;
  format: string;
  level: Level;
  note: string;
}

interface KeyFigures {
  type: "key_figures";
  figures: KeyFigure[];
}

export type SeriesKind = "line" | "points" | "steps" | "band" | "bars";
export type Tone = "auto" | "measured" | "model" | "residual" | "threshold" | "faint";

/** How a series is drawn, without its numbers. */
export interface SeriesStyle {
  kind: SeriesKind;
  tone: Tone;
  dashed: boolean;
}

export interface Series extends SeriesStyle {
  name: string;
  y_axis: number;
  x: Value[];
  y: Value[];
  y_upper?: Value[];
}

export interface EventMark {
  x: number;
  label: string;
  level: Level;
}

interface SpanMark {
  from: Value;
  to: Value;
  label: string;
  level: Level;
}

export interface LevelMark {
  y: number;
  label: string;
}

export interface Chart {
  type: "chart";
  title: string;
  x: Axis;
  y: Axis[];
  series: Series[];
  events: EventMark[];
  spans: SpanMark[];
  levels: LevelMark[];
  zoom_group: string;
  slider: boolean;
  width: Width;
  note: string;
}

export interface Heatmap {
  type: "heatmap";
  title: string;
  x: Axis;
  y: Axis;
  value_axis: Axis;
  x_edges: Value[];
  y_edges: Value[];
  value: Value[];
  diverging: boolean;
  width: Width;
  note: string;
}

export interface WaterfallStep {
  label: string;
  value: Value;
}

export interface Waterfall {
  type: "waterfall";
  title: string;
  value_axis: Axis;
  steps: WaterfallStep[];
  levels: LevelMark[];
  format: string;
  width: Width;
  note: string;
}

export interface Note {
  type: "note";
  text: string;
  level: Level;
}

/** What is drawn, and can be saved. */
export type Drawn = Chart | Heatmap | Waterfall;
export type Block = Table | KeyFigures | Note | Drawn;

export interface Section {
  heading: string;
  text: string;
  blocks: Block[];
  recording: string;
}

export interface Page {
  title: string;
  subtitle: string;
  version: string;
  verdict: { words: string; level: Level };
  sections: Section[];
  command_line: string;
}
