#include <algorithm>
#include <cmath>
#include <numbers>

#include "discovery/effects/effects.hpp"
#include "signal/differentiate.hpp"
#include "signal/quantile.hpp"

namespace offnominal::tools::discovery {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::VectorXd;

ArrayXd elapsed(const Workspace& at) { return at.motion.t_s.array() - at.start_s; }

class Offset final : public EffectCandidate {
 public:
  const char* name() const override { return "torque_offset"; }
  const char* formula() const override { return "level"; }
  const char* words() const override { return "a constant torque"; }
  const char* motion_hint() const override { return "rest at several positions"; }
  std::vector<LinearParameter> linear_parameters(JointType type) const override {
    return {{"level", unit(Quantity::kEffort, type)}};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> /*shape*/) const override {
    return {{{joint, VectorXd::Ones(at.sample_count())}}};
  }
  bool applies(const Workspace& /*at*/, Index /*joint*/) const override { return true; }
  bool acts_at_rest(const Workspace& /*at*/, Index /*joint*/) const override { return true; }
};

class Scale final : public EffectCandidate {
 public:
  const char* name() const override { return "torque_scale"; }
  const char* formula() const override { return "error * (torque of the model)"; }
  const char* words() const override { return "a wrong torque constant"; }
  const char* motion_hint() const override { return "move with a payload of known mass"; }
  std::vector<LinearParameter> linear_parameters(JointType /*type*/) const override {
    return {{"error", "1"}};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> /*shape*/) const override {
    return {{{joint, at.model_torque.col(joint)}}};
  }
  bool acts_at_rest(const Workspace& /*at*/, Index /*joint*/) const override { return true; }
};

class Stiffness final : public EffectCandidate {
 public:
  const char* name() const override { return "joint_stiffness"; }
  const char* formula() const override { return "stiffness * (q - rest_position)"; }
  const char* words() const override { return "a spring or cable that pulls to a rest position"; }
  const char* motion_hint() const override { return "move over the whole range, slowly"; }
  std::vector<LinearParameter> linear_parameters(JointType type) const override {
    return {{"stiffness", unit(Quantity::kEffortPerPosition, type)},
            {"offset", unit(Quantity::kEffort, type)}};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> /*shape*/) const override {
    return {{{joint, at.motion.q.col(joint)}}, {{joint, VectorXd::Ones(at.sample_count())}}};
  }
  std::vector<NamedValue> parameters(JointType type, const VectorXd& coefficients,
                                     const ShapePoint& /*shape*/,
                                     const std::vector<ShapeRange>& /*ranges*/) const override {
    return {{"stiffness", coefficients[0], unit(Quantity::kEffortPerPosition, type)},
            {"rest_position", -coefficients[1] / coefficients[0], unit(Quantity::kPosition, type)}};
  }
  bool acts_at_rest(const Workspace& /*at*/, Index /*joint*/) const override { return true; }
};

// Half a period between neighbouring positions, as they are apart mostly; per rad or m.
double highest_order_held(const Workspace& at, Index joint) {
  VectorXd q = at.motion.q.col(joint);
  std::sort(q.begin(), q.end());
  const VectorXd apart = q.tail(q.size() - 1) - q.head(q.size() - 1);
  std::vector<double> steps;
  for (const double step : apart) {
    if (step > 0) steps.push_back(step);
  }
  if (steps.empty()) return 0;
  const VectorXd all = Eigen::Map<const VectorXd>(steps.data(), static_cast<Index>(steps.size()));
  constexpr double kMostly = 0.9;
  return 0.5 / quantile(all, kMostly) * 2 * std::numbers::pi;
}

class Cogging final : public EffectCandidate {
 public:
  const char* name() const override { return "cogging_torque"; }
  const char* formula() const override {
    return "sine * sin(k q) + cosine * cos(k q), k = order (revolute) or 2 pi order (prismatic)";
  }
  const char* words() const override { return "a torque ripple that repeats with position"; }
  const char* motion_hint() const override { return "move slowly over several periods"; }
  std::vector<LinearParameter> linear_parameters(JointType type) const override {
    return {{"sine", unit(Quantity::kEffort, type)}, {"cosine", unit(Quantity::kEffort, type)}};
  }
  std::vector<ShapeRange> shapes(const std::vector<Workspace>& at, Index joint) const override {
    const JointType type = at[0].joint_type(joint);
    const double per_unit = first_order_period(type);
    const double range = range_moved(at, joint) / per_unit;
    double highest = 0;
    for (const Workspace& one : at) {
      if (one.at_rest) highest = std::max(highest, highest_order_held(one, joint) / per_unit);
      const double slow = std::max(quantile(one.motion.dq.col(joint).cwiseAbs(), 0.3),
                                   0.05 * one.top_speed[joint]) /
                          per_unit;
      if (slow > 0) highest = std::max(highest, one.plan.torque_cutoff_hz / slow);
    }
    ShapeRange order{"order", unit(Quantity::kCyclesPerPosition, type), {}};
    if (!(range > 0)) return {order};
    constexpr double kMost = 1500;
    const double step = 0.5 / range;
    const double last = std::min(highest, (2 / range) + kMost * step);
    for (double k = 2 / range; k <= last; k += step) order.grid.push_back(k);
    return {order};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> shape) const override {
    const double k = 2 * std::numbers::pi / first_order_period(at.joint_type(joint));
    const ArrayXd phase = shape[0] * k * at.motion.q.col(joint).array();
    std::vector<Regressor> columns{{{joint, phase.sin().matrix()}},
                                   {{joint, phase.cos().matrix()}}};
    if (!at.both_ways(joint)) return columns;
    // Friction holds a joint a little before where the ripple would: by the direction of approach
    // the reading is shifted along it.
    for (std::size_t i = 0; i < 2; ++i) {
      columns.push_back(
          {{joint, columns[i][0].values.cwiseProduct(at.approach.col(joint)).eval()}});
    }
    return columns;
  }
  Spectrum spectrum() const override { return Spectrum::kPosition; }
  bool acts_at_rest(const Workspace& /*at*/, Index /*joint*/) const override { return true; }
};

class Periodic final : public EffectCandidate {
 public:
  const char* name() const override { return "periodic_disturbance"; }
  const char* formula() const override {
    return "sine * sin(frequency t) + cosine * cos(frequency t)";
  }
  const char* words() const override { return "a disturbance that repeats in time"; }
  const char* motion_hint() const override { return "record for longer"; }
  std::vector<LinearParameter> linear_parameters(JointType type) const override {
    return {{"sine", unit(Quantity::kEffort, type)}, {"cosine", unit(Quantity::kEffort, type)}};
  }
  std::vector<ShapeRange> shapes(const std::vector<Workspace>& at, Index /*joint*/) const override {
    ShapeRange frequency{"frequency", "rad/s", {}};
    const double duration_s = longest_duration_s(at);
    // The filter's edge is no wall: a quarter above it a sixth of the amplitude is left, of effect
    // and regressor alike. Half the rate of what is kept is one.
    constexpr double kBeyondCutoff = 1.25;
    constexpr double kBelowHalfRate = 0.99;
    double highest_hz = 0;
    for (const Workspace& one : at) {
      highest_hz = std::max(highest_hz, std::min(kBeyondCutoff * one.plan.torque_cutoff_hz,
                                                 kBelowHalfRate * 0.5 / one.plan.period_s()));
    }
    const double whole = 2 * std::numbers::pi / duration_s;
    const double last = 2 * std::numbers::pi * highest_hz;
    constexpr double kMost = 4000;
    const double step = std::max(0.5 * whole, last / kMost);
    for (double w = 5 * whole; w < last; w += step) frequency.grid.push_back(w);
    return {frequency};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> shape) const override {
    const ArrayXd phase = shape[0] * elapsed(at);
    return {{{joint, phase.sin().matrix()}}, {{joint, phase.cos().matrix()}}};
  }
  Spectrum spectrum() const override { return Spectrum::kTime; }
  bool applies(const Workspace& /*at*/, Index /*joint*/) const override { return true; }
};

class Delay final : public EffectCandidate {
 public:
  const char* name() const override { return "time_delay"; }
  const char* formula() const override { return "torque(t) is logged `delay` before it acts"; }
  const char* words() const override { return "a drive that executes its torque late"; }
  const char* motion_hint() const override {
    return "accelerate at two frequencies at least, the higher the better";
  }
  std::vector<LinearParameter> linear_parameters(JointType /*type*/) const override {
    return {{"delay", "s"}};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> /*shape*/) const override {
    return {{{joint, central_difference(at.model_torque.col(joint), at.period_s())}}};
  }
  bool is_physical(const Eigen::VectorXd& c) const override { return c[0] > 0; }
  bool replaces_skew() const override { return true; }
};

class Coupling final : public EffectCandidate {
 public:
  const char* name() const override { return "joint_coupling"; }
  const char* formula() const override {
    return "coefficient * dq_k + level * tanh(dq_k / smoothing), k = source_joint";
  }
  const char* words() const override { return "friction from the motion of another joint"; }
  const char* motion_hint() const override { return "move one joint at a time"; }
  std::vector<LinearParameter> linear_parameters(JointType type) const override {
    return {{"coefficient", unit(Quantity::kEffortPerVelocity, type)},
            {"level", unit(Quantity::kEffort, type)}};
  }
  std::vector<ShapeRange> shapes(const std::vector<Workspace>& at, Index joint) const override {
    ShapeRange source{"source_joint", "", {}, ShapeRange::Kind::kDiscrete};
    for (Index k = 0; k < at[0].joint_count(); ++k) {
      if (k != joint && at[0].top_speed[k] > 0) source.grid.push_back(static_cast<double>(k + 1));
    }
    return {source};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> shape) const override {
    const auto source = static_cast<Index>(shape[0]) - 1;
    return {{{joint, at.motion.dq.col(source)}}, {{joint, at.sign(source).matrix()}}};
  }
  bool applies(const Workspace& at, Index /*joint*/) const override { return at.joint_count() > 1; }
};

class TemperatureDrift final : public EffectCandidate {
 public:
  const char* name() const override { return "temperature_drift"; }
  const char* formula() const override {
    return "exp(-t / time_constant) * (level * tanh(dq / smoothing) + coefficient * dq)";
  }
  const char* words() const override { return "friction that changes while the joint warms up"; }
  const char* motion_hint() const override {
    return "repeat the same motion from a cold start for several time constants";
  }
  std::vector<LinearParameter> linear_parameters(JointType type) const override {
    return {{"level", unit(Quantity::kEffort, type)},
            {"coefficient", unit(Quantity::kEffortPerVelocity, type)}};
  }
  std::vector<ShapeRange> shapes(const std::vector<Workspace>& at, Index /*joint*/) const override {
    const double duration_s = longest_duration_s(at);
    // What has not faded by the end is friction that stays: beyond kLongest this effect would stand
    // for Coulomb and viscous friction at once.
    constexpr double kLongest = 0.75;
    return {{"time_constant", "s", logarithmic_grid(duration_s / 12, kLongest * duration_s),
             ShapeRange::Kind::kLogarithmic}};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> shape) const override {
    const ArrayXd fade = (-elapsed(at) / shape[0]).exp();
    return {{{joint, (fade * at.sign(joint)).matrix()}},
            {{joint, (fade * at.motion.dq.col(joint).array()).matrix()}}};
  }
};

}  // namespace

void add_drive_effects(Candidates& all) {
  all.push_back(std::make_unique<Offset>());
  all.push_back(std::make_unique<Scale>());
  all.push_back(std::make_unique<Stiffness>());
  all.push_back(std::make_unique<Cogging>());
  all.push_back(std::make_unique<Periodic>());
  all.push_back(std::make_unique<Delay>());
  all.push_back(std::make_unique<Coupling>());
  all.push_back(std::make_unique<TemperatureDrift>());
}

}  // namespace offnominal::tools::discovery
