// Data as the server says it, as little as a test needs; what it is about it says itself.
import type { Axis, Chart, Series } from "../report/document";
import type { Arm, ArmJoint, Step } from "../studio/api";

export function axis(change: Partial<Axis> = {}): Axis {
  return { name: "time", unit: "s", log: false, min: null, max: null, ...change };
}

export function series(change: Partial<Series> = {}): Series {
  return { name: "measured", kind: "line", tone: "measured", dashed: false, y_axis: 0, x: [0, 1, 2], y: [1, 2, 3], ...change };
}

export function chart(change: Partial<Chart> = {}): Chart {
  return {
    type: "chart",
    title: "Torque",
    x: axis(),
    y: [axis({ name: "torque", unit: "N m" })],
    series: [series()],
    events: [],
    spans: [],
    levels: [],
    zoom_group: "",
    slider: false,
    width: "full",
    note: "",
    ...change,
  };
}

export function armJoint(change: Partial<ArmJoint> = {}): ArmJoint {
  return {
    joint: 1,
    name: "shoulder",
    type: "revolute",
    unit: "rad",
    torque_unit: "N m",
    axis: [0, 0, 1],
    origin_m: [0, 0, 0],
    centre_of_mass_m: [0, 0, 0],
    end_m: [1, 0, 0],
    rail_m: null,
    rms_torque: 10,
    rms_error: 1,
    error_percent: 10,
    ...change,
  };
}

/** One joint at three instants. */
export function arm(change: Partial<Arm> = {}): Arm {
  return {
    revision: 0,
    recording: 1,
    gravity_m_s2: [0, 0, -9.81],
    reach_m: 1,
    knows_lengths: true,
    joints: [armJoint()],
    t_s: [0, 1, 2],
    position: [[0.1, 0.2, 0.3]],
    measured: [[1, 2, 3]],
    model: [[1, 1, 1]],
    error: [[0, 1, 2]],
    percent: [[0, 10, 60]],
    over_bound: null,
    low_m: [0, 0, 0],
    high_m: [1, 0, 0],
    place_m: [[0, 0, 0, 0, 0, 0, 0, 0, 0]],
    turn: [[0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]],
    ...change,
  };
}

export function step(change: Partial<Step> = {}): Step {
  return {
    id: 1,
    effect: "viscous_friction",
    words: "friction proportional to speed",
    joint: 1,
    parameters: {},
    draggable: {},
    refitted: [],
    before: { fitted_percent: 4, held_out_percent: 4 },
    after: { fitted_percent: 2, held_out_percent: 2 },
    verdict: "better",
    notes: [],
    doubts: [],
    ...change,
  };
}
