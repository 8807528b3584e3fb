// A run as a recording, as a controller would have written it down.
#pragma once

#include "log/log.hpp"
#include "paper/experiment.hpp"

namespace offnominal::desk::paper {

/// One sample per tick and one before the first, on the desired motion, from which the monitor
/// starts. The torque of a sample is what was applied over the tick that ends at it, as
/// torque_signal = "held" takes it. `run` is what run_experiment(robot, experiment) gave; throws
/// std::invalid_argument where its series was not recorded.
[[nodiscard]] Log recording_of(const RobotDescription& robot, const Experiment& experiment,
                               const ExperimentResult& run);

/// Of a run over a bus: one sample per tick with a fresh reading of every joint, as the controller
/// saw it, and what was true as q_true1.., dq_true1.., tau_true1.. (the torque that acted). Throws
/// std::invalid_argument where the series was not recorded.
[[nodiscard]] Log seen_recording_of(const RobotDescription& robot, const TimeSeries& series);

}  // namespace offnominal::desk::paper
