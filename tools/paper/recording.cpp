#include "paper/recording.hpp"

#include <stdexcept>

namespace offnominal::tools::paper {

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
    put(log.q, start.q[joint], series.q[joint]);
    put(log.dq, start.dq[joint], series.dq[joint]);
    put(log.tau, series.tau[joint].front(), series.tau[joint]);
  }
  log.dq_derived = {false, false};
  return log;
}

}  // namespace offnominal::tools::paper
