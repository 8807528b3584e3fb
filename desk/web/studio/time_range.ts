import type { Zoom } from "../report/zoom";

/** A part of the time, s of the recording. */
export interface TimeRange {
  from: number;
  to: number;
}

/** What a zoom leaves of the time; null: all of it. */
export function rangeOf({ start, end, startValue, endValue }: Zoom): TimeRange | null {
  if (start <= 0.01 && end >= 99.99) return null;
  return startValue < endValue ? { from: startValue, to: endValue } : null;
}
