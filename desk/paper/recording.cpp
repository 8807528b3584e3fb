#include "paper/recording.hpp"

#include <stdexcept>
#include <string>
#include <vector>

namespace offnominal::desk::paper {

Log seen_recording_of(const RobotDescription& robot, const TimeSeries& series) {
  if (series.time_s.empty()) throw std::invalid_argument("the run was not recorded");
  const Eigen::Index joints = robot.joint_count();
  std::vector<std::size_t> fresh;
  for (std::size_t i = 0; i < series.bus.size(); ++i) {
    if (series.bus[i].fresh) fresh.push_back(i);
  }
  const auto rows = static_cast<Eigen::Index>(fresh.size());
  Log log;
  log.file = "sil";
  log.period_s = robot.estimator.period_s;
  log.t_s.resize(rows);
  for (Eigen::MatrixXd* columns : {&log.q, &log.dq, &log.tau}) columns->resize(rows, joints);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const std::size_t tick = fresh[static_cast<std::size_t>(row)];
    const BusTick& bus = series.bus[tick];
    log.t_s[row] = series.time_s[tick];
    log.q.row(row) = bus.seen.q;
    log.dq.row(row) = bus.seen.dq;
    log.tau.row(row) = bus.seen_tau;
  }
  for (Eigen::Index joint = 0; joint < joints; ++joint) {
    const auto put = [&](const char* name, const auto& value_at) {
      Eigen::VectorXd& column = log.extra[name + std::to_string(joint + 1)];
      column.resize(rows);
      for (Eigen::Index row = 0; row < rows; ++row) {
        column[row] = value_at(fresh[static_cast<std::size_t>(row)]);
      }
    };
    put("q_true",
        [&](std::size_t tick) { return series.q[static_cast<std::size_t>(joint)][tick]; });
    put("dq_true",
        [&](std::size_t tick) { return series.dq[static_cast<std::size_t>(joint)][tick]; });
    put("tau_true", [&](std::size_t tick) { return series.bus[tick].acting_tau[joint]; });
    put("compensation", [&](std::size_t tick) { return series.bus[tick].compensation[joint]; });
  }
  log.dq_derived.assign(robot.joints.size(), false);
  return log;
}

Log recording_of(const RobotDescription& robot, const Experiment& experiment,
                 const ExperimentResult& run) {
  const TimeSeries& series = run.series;
  if (series.time_s.empty()) throw std::invalid_argument("the run was not recorded");
  const auto ticks = static_cast<Eigen::Index>(series.time_s.size());
  const sim::DesiredMotion start = experiment.desired_at(0);
  Log log;
  log.file = "paper";
  log.period_s = robot.estimator.period_s;
  log.t_s.resize(ticks + 1);
  log.t_s[0] = 0;
  log.t_s.tail(ticks) = Eigen::Map<const Eigen::VectorXd>(series.time_s.data(), ticks);
  for (Eigen::MatrixXd* columns : {&log.q, &log.dq, &log.tau}) columns->resize(ticks + 1, 2);
  for (Eigen::Index joint = 0; joint < 2; ++joint) {
    const auto put = [&](Eigen::MatrixXd& columns, double first, const std::vector<double>& rest) {
      columns(0, joint) = first;
      columns.col(joint).tail(ticks) = Eigen::Map<const Eigen::VectorXd>(rest.data(), ticks);
    };
    const auto j = static_cast<std::size_t>(joint);
    put(log.q, start.q[joint], series.q[j]);
    put(log.dq, start.dq[joint], series.dq[j]);
    put(log.tau, series.tau[j].front(), series.tau[j]);
  }
  log.dq_derived = {false, false};
  return log;
}

}  // namespace offnominal::desk::paper
