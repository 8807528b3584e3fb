import { labelStep } from "../report/axes";
import { itemAt } from "../report/lists";
import type { LiveSteps } from "./api";

/** s, and the value there; a gap is null. */
export type Point = [number, number | null];

/** What is drawn of the last seconds, of one that is judged. */
export interface LiveCurve {
  residual: Point[];
  threshold: Point[];
  /** The level to act; empty where there is one level. */
  act: Point[];
}

/** The end of an axis that begins at 0, and the step between its labels. */
export interface Scale {
  top: number;
  step: number;
}

export const kLiveWindowS = 10;

export function emptyCurves(count: number): LiveCurve[] {
  return Array.from({ length: count }, () => ({ residual: [], threshold: [], act: [] }));
}

/** Appends the new steps of the server and lets go of what has left the window. */
export function appendSteps(curves: LiveCurve[], steps: LiveSteps, stepS: number) {
  curves.forEach((curve, of) => {
    const low = itemAt(steps.low, of);
    const high = itemAt(steps.high, of);
    const threshold = itemAt(steps.threshold, of);
    const act = steps.act[of];
    steps.t_s.forEach((t, at) => {
      if (t === null) return;
      const last = curve.threshold.at(-1);
      if (last !== undefined && t - last[0] > 2.5 * stepS) {
        curve.residual.push([last[0] + stepS, null]);
        curve.threshold.push([last[0] + stepS, null]);
        if (act !== undefined) curve.act.push([last[0] + stepS, null]);
      }
      curve.residual.push([t, low[at] ?? null], [t + stepS / 2, high[at] ?? null]);
      curve.threshold.push([t, threshold[at] ?? null]);
      if (act !== undefined) curve.act.push([t, act[at] ?? null]);
    });
    const newest = curve.threshold.at(-1)?.[0] ?? 0;
    for (const points of [curve.residual, curve.threshold, curve.act]) {
      const first = points.findIndex(([t]) => t >= newest - kLiveWindowS - 1);
      points.splice(0, first < 0 ? points.length : first);
    }
  });
}

/** The end of the axis of what is never negative, and the step between its labels. */
export function liveScale(curve: LiveCurve): Scale {
  let most = 0;
  for (const points of [curve.residual, curve.threshold, curve.act]) {
    for (const [, value] of points) if (value !== null && value > most) most = value;
  }
  const step = labelStep(most > 0 ? 1.05 * most : 1, 3);
  return { step, top: step * Math.ceil((1.05 * most) / step || 1) };
}
