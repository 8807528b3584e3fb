#include "compare/compare.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "signal/norm_about_mean.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double percent_of(double part, double whole) {
  return whole > 0 ? 100 * part / whole : std::numeric_limits<double>::quiet_NaN();
}

// What counts of one joint: while it moves.
struct JointSamples {
  VectorXd measured;
  VectorXd error;
  VectorXd q;
  VectorXd dq;
  VectorXd ddq;
  VectorXd t_s;
  VectorXd recording;   // which one, from 0
  VectorXd gear;        // measured less what a sensor behind the gear says; empty: no such sensor
  Index of = 0;         // samples in all
  double at_fault = 0;  // of them, where the recording is
};

JointSamples samples_of(const Comparison& all, Index joint) {
  const auto moving = all.moving.col(joint);
  const auto while_moving = [&](const auto& values) {
    VectorXd kept(values.size());
    Index count = 0;
    for (Index i = 0; i < values.size(); ++i) {
      if (moving[i] > 0) kept[count++] = values[i];
    }
    return VectorXd(kept.head(count));
  };
  JointSamples samples;
  samples.measured = while_moving(all.measured.col(joint));
  samples.error = samples.measured - while_moving(all.model.col(joint));
  samples.q = while_moving(all.q.col(joint));
  samples.dq = while_moving(all.dq.col(joint));
  samples.ddq = while_moving(all.ddq.col(joint));
  samples.t_s = while_moving(all.t_s);
  if (all.sensor.cols() > 0 && all.has_both[static_cast<std::size_t>(joint)] != 0) {
    samples.gear = samples.measured - while_moving(all.sensor.col(joint));
  }
  samples.recording = VectorXd::Zero(samples.error.size());
  samples.of = all.t_s.size();
  samples.at_fault = all.at_fault[joint] * static_cast<double>(samples.of);
  return samples;
}

void append(VectorXd& to, const VectorXd& values) {
  to.conservativeResize(to.size() + values.size());
  to.tail(values.size()) = values;
}

// Of all recordings, their times one after the other.
JointSamples samples_of(const std::vector<Comparison>& recordings, Index joint) {
  JointSamples whole;
  double end_s = 0;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    JointSamples part = samples_of(recordings[r], joint);
    const VectorXd& t_s = recordings[r].t_s;
    part.t_s.array() += end_s - t_s[0];
    end_s += t_s[t_s.size() - 1] - t_s[0];
    part.recording.setConstant(static_cast<double>(r));
    append(whole.measured, part.measured);
    append(whole.error, part.error);
    append(whole.q, part.q);
    append(whole.dq, part.dq);
    append(whole.ddq, part.ddq);
    append(whole.t_s, part.t_s);
    append(whole.recording, part.recording);
    append(whole.gear, part.gear);
    whole.of += part.of;
    whole.at_fault += part.at_fault;
  }
  // Recordings with the sensor and without it: of the whole there is nothing to say.
  if (whole.gear.size() != whole.measured.size()) whole.gear.resize(0);
  return whole;
}

// Of the energy about the mean, what the means of the recordings explain.
double share_of_recordings(const JointSamples& samples) {
  const double mean = samples.error.mean();
  const double energy = (samples.error.array() - mean).square().sum();
  const auto last = static_cast<Index>(samples.recording.maxCoeff());
  double between = 0;
  for (Index r = 0; r <= last && energy > 0; ++r) {
    const auto own = (samples.recording.array() == static_cast<double>(r)).cast<double>();
    const double count = own.sum();
    if (!(count > 0)) continue;
    const double apart = (samples.error.array() * own).sum() / count - mean;
    between += count * apart * apart;
  }
  return energy > 0 ? std::min(between / energy, 1.0) : 0;
}

// What `error`, of the samples that count, follows of the motion and the time.
std::vector<ErrorShare> followed(const JointSamples& samples, const VectorXd& error) {
  return {{"position", share_explained(samples.q, error)},
          {"velocity", share_explained(samples.dq, error)},
          {"acceleration", share_explained(samples.ddq, error)},
          {"time", share_explained(samples.t_s, error)}};
}

// What gear and rotor take. Whatever is smooth follows the time; a gear is known by its motion.
GearTorque gear_of(const JointSamples& samples) {
  std::vector<ErrorShare> follows = followed(samples, samples.gear);
  std::erase_if(follows, [](const ErrorShare& one) { return one.variable == "time"; });
  const double root_n = std::sqrt(static_cast<double>(samples.gear.size()));
  return {samples.gear.norm() / root_n, percent_of(samples.gear.norm(), samples.measured.norm()),
          *std::max_element(
              follows.begin(), follows.end(),
              [](const ErrorShare& a, const ErrorShare& b) { return a.share < b.share; })};
}

JointComparison compare_joint(const JointSamples& samples, std::size_t joint,
                              const std::string& unit) {
  const VectorXd& measured = samples.measured;
  const VectorXd& error = samples.error;
  const double root_n = std::sqrt(static_cast<double>(measured.size()));
  JointComparison result;
  result.joint = joint;
  result.unit = unit;
  result.samples = measured.size();
  result.at_fault = samples.at_fault / static_cast<double>(samples.of);
  if (measured.size() == 0) {  // nothing of it counts
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    result.rms_error = result.rms_torque = kNone;
    result.relative_error_percent = result.fit_percent = kNone;
    result.left_out = 1;
    result.where = {{"time", 0}};
    return result;
  }
  result.rms_error = error.norm() / root_n;
  result.rms_torque = measured.norm() / root_n;
  result.relative_error_percent = percent_of(error.norm(), measured.norm());
  const double spread = norm_about_mean(measured);
  // Rounding makes the spread of a constant a little more than 0.
  const bool constant = spread <= 1e-12 * measured.norm();
  result.fit_percent = 100 - percent_of(error.norm(), constant ? 0 : spread);
  result.left_out = 1 - static_cast<double>(measured.size()) / static_cast<double>(samples.of);
  result.where = followed(samples, error);
  if (samples.recording.size() > 0 && samples.recording.maxCoeff() > 0) {
    result.where.push_back({"recording", share_of_recordings(samples)});
  }
  std::stable_sort(result.where.begin(), result.where.end(),
                   [](const ErrorShare& a, const ErrorShare& b) { return a.share > b.share; });
  if (samples.gear.size() > 0) result.gear = gear_of(samples);
  return result;
}

}  // namespace

Comparison compare(const RobotDescription& robot, const Measurement& measured) {
  ModelTorqueMemory memory;
  return compare(robot, measured, memory);
}

Comparison compare(const RobotDescription& robot, const Measurement& measured,
                   ModelTorqueMemory& memory) {
  Comparison result;
  result.file = measured.log->file;
  result.payload = measured.log->payload;
  result.plan = measured.plan;
  result.t_s = measured.t_s;
  result.measured = measured.torque;
  result.model = memory.filtered(robot, measured);
  result.remarks = measured.log->remarks;
  const auto kept = [&](const MatrixXd& columns) {
    MatrixXd samples(result.t_s.size(), columns.cols());
    for (Index joint = 0; joint < columns.cols(); ++joint) {
      samples.col(joint) = kept_samples(measured.plan, columns.col(joint));
    }
    return samples;
  };
  result.q = kept(measured.motion.q);
  result.dq = kept(measured.motion.dq);
  result.ddq = kept(measured.motion.ddq);
  result.moving = measured.moving;
  result.sensor = measured.sensor_torque;
  for (Index joint = 0; joint < result.measured.cols(); ++joint) {
    result.has_both.push_back(measured.log->has_both(static_cast<std::size_t>(joint)) ? 1 : 0);
  }
  result.at_fault = measured.at_fault;
  for (Index joint = 0; joint < result.measured.cols(); ++joint) {
    const auto which = static_cast<std::size_t>(joint);
    result.joints.push_back(
        compare_joint(samples_of(result, joint), which,
                      unit_of(Quantity::kEffort, robot.joints[which].joint.type)));
  }
  return result;
}

Comparisons together(std::vector<Comparison> recordings) {
  Comparisons all{std::move(recordings), {}};
  if (all.recordings.size() == 1) {
    all.joints = all.recordings[0].joints;
    return all;
  }
  for (const JointComparison& of_first : all.recordings.front().joints) {
    all.joints.push_back(
        compare_joint(samples_of(all.recordings, static_cast<Index>(of_first.joint)),
                      of_first.joint, of_first.unit));
  }
  return all;
}

double share_explained(const Eigen::Ref<const VectorXd>& variable,
                       const Eigen::Ref<const VectorXd>& values, int bins) {
  const Index n = values.size();
  const double mean = values.mean();
  const double energy = (values.array() - mean).square().sum();
  if (!(energy > 0) || variable.maxCoeff() == variable.minCoeff()) return 0;
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return variable[a] < variable[b]; });
  double between = 0;
  for (int bin = 0; bin < bins; ++bin) {
    const Index first = n * bin / bins;
    const Index end = n * (bin + 1) / bins;
    if (first == end) continue;
    double sum = 0;
    for (Index i = first; i < end; ++i) sum += values[order[static_cast<std::size_t>(i)]] - mean;
    between += sum * sum / static_cast<double>(end - first);
  }
  return std::min(between / energy, 1.0);
}

}  // namespace offnominal::desk
