// What a run is judged by: gathers numbers and, where asked for, time series, tick by tick.
#pragma once

#include "paper/closed_loop.hpp"
#include "paper/experiment.hpp"

namespace offnominal::tools::paper {

class RunObserver {
 public:
  /// Both have to outlive it. fault_time_s: until when nothing is wrong; the run's end or later
  /// where nothing ever is.
  RunObserver(const RobotDescription& robot, const Experiment& experiment, double fault_time_s);

  /// In the order of time.
  void operator()(const TickRecord& tick);

  /// Numbers and series, what the run was, but for fault_time_s.
  [[nodiscard]] ExperimentResult finish();

 private:
  // Sums of squares over the window in which the paper's figures have settled.
  struct WindowSums {
    double tracking = 0.0, psi = 0.0, mismatch = 0.0;
    std::int64_t ticks = 0;
  };

  void judge(const TickRecord& tick);
  void add_to_window(const TickRecord& tick);
  void keep(const TickRecord& tick);

  const RobotDescription& robot_;
  const Experiment& experiment_;
  double decay_, input_gain_, healthy_until_, window_start_, tolerance_;
  Eigen::Vector2d eta_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d last_psi_ = Eigen::Vector2d::Zero();
  WindowSums window_;
  ExperimentResult result_;
};

}  // namespace offnominal::tools::paper
