// The numbers of Truth mean what case.hpp says: the formula that a user would write down with them
// explains what the effect adds to the torque, sign included.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "unexplained.hpp"

namespace offnominal::sim::hidden {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;

double value(const TrueEffect& hidden, const std::string& parameter) {
  for (const TrueParameter& p : hidden.parameters) {
    if (p.name == parameter) return p.value;
  }
  throw std::out_of_range(parameter);
}

bool has(const TrueEffect& hidden, const std::string& parameter) {
  for (const TrueParameter& p : hidden.parameters) {
    if (p.name == parameter) return true;
  }
  return false;
}

// Means over each sample.
struct Signals {
  ArrayXd t, q, v, a, other_v, tau, earlier_tau;
  Eigen::MatrixXd all_q, all_v, all_a;
};

Signals signals(const Trace& trace, int joint, double delay_s) {
  const Index n = trace.t_s.size() - 1;
  const auto middle = [n](const Eigen::MatrixXd& m) -> Eigen::MatrixXd {
    return 0.5 * (m.topRows(n) + m.bottomRows(n));
  };
  Signals s;
  s.all_q = middle(trace.motor_q);
  s.all_v = middle(trace.motor_dq);
  s.all_a = (trace.motor_dq.bottomRows(n) - trace.motor_dq.topRows(n)) * 1000.0;
  s.t = trace.t_s.head(n).array() + 0.0005;
  s.q = s.all_q.col(joint);
  s.v = s.all_v.col(joint);
  s.a = s.all_a.col(joint);
  s.other_v = s.all_v.col(1 - joint);
  s.tau = trace.commanded_nm.col(joint).head(n);
  s.earlier_tau = s.tau;
  const double rows = delay_s * 1000.0, whole = std::floor(rows), part = rows - whole;
  for (Index k = static_cast<Index>(whole) + 1; k < n; ++k) {
    const Index back = k - static_cast<Index>(whole);
    s.earlier_tau[k] = (1.0 - part) * s.tau[back] + part * s.tau[back - 1];
  }
  return s;
}

ArrayXd added_mass_torque(const Robot& with, const Robot& without, const Signals& s, int joint) {
  const PlanarArm heavy = with.arm(), light = without.arm();
  ArrayXd torque(s.t.size());
  for (Index k = 0; k < torque.size(); ++k) {
    const Eigen::Vector2d q = s.all_q.row(k), v = s.all_v.row(k), a = s.all_a.row(k);
    torque[k] = heavy.torque(q, v, a)[joint] - light.torque(q, v, a)[joint];
  }
  return torque;
}

// Load on the gear: what the links of the robot without the effect take.
ArrayXd gear_load(const Robot& robot, const Signals& s, int joint) {
  Robot weightless = robot;
  for (RigidLink& link : weightless.links) link.mass_kg = link.inertia_kg_m2 = 0.0;
  return added_mass_torque(robot, weightless, s, joint);
}

ArrayXd friction_formula(const TrueEffect& h, const Robot& base, const Signals& s) {
  const ArrayXd sign = s.v.sign();
  const auto get = [&h](const char* parameter) { return value(h, parameter); };
  switch (h.effect) {
    case HiddenEffect::kCoulombFriction:
      return get("level") * sign;
    case HiddenEffect::kViscousFriction:
      return get("coefficient") * s.v;
    case HiddenEffect::kQuadraticFriction:
      return get("coefficient") * s.v * s.v.abs();
    case HiddenEffect::kStribeckFriction:
      return get("level") * (-(s.v / get("stribeck_velocity")).square()).exp() * sign;
    case HiddenEffect::kFrictionAsymmetry:
      return get("level") + get("coefficient") * s.v.abs();
    case HiddenEffect::kLoadDependentFriction:
      return get("coefficient") * gear_load(base, s, h.joint).abs() * sign;
    case HiddenEffect::kGearLoss: {
      const ArrayXd load = gear_load(base, s, h.joint);
      return (load * sign > 0)
                 .select(get("driving_loss"), ArrayXd::Constant(load.size(), get("driven_loss"))) *
             load.abs() * sign;
    }
    case HiddenEffect::kTemperatureDrift:
      return (-s.t / get("time_constant")).exp() * (get("level") * sign + get("coefficient") * s.v);
    case HiddenEffect::kHysteresis: {
      JointFriction soft;
      soft.coulomb_nm = get("level");
      soft.width_rad = get("width");
      return test::friction_along(soft, s.v, 1e-3).array();
    }
    default:
      throw std::invalid_argument("no friction");
  }
}

ArrayXd formula(const TrueEffect& h, const Robot& robot, const Robot& base, const Signals& s) {
  const auto get = [&h](const char* parameter) { return value(h, parameter); };
  switch (h.effect) {
    case HiddenEffect::kTorqueOffset:
      return ArrayXd::Constant(s.t.size(), get("level"));
    case HiddenEffect::kTorqueScale:
      return -get("share") * s.tau;
    case HiddenEffect::kRotorInertia:
      return get("inertia") * s.a;
    case HiddenEffect::kLinkMass:
    case HiddenEffect::kTipPayload:
      return added_mass_torque(robot, base, s, h.joint);
    case HiddenEffect::kCoggingTorque:
      return get("sine") * (get("order") * s.q).sin() + get("cosine") * (get("order") * s.q).cos();
    case HiddenEffect::kJointStiffness:
      return get("stiffness") * (s.q - get("rest_position"));
    case HiddenEffect::kPositionTorque: {
      // Foot at (0.4 m, 0), pin at `pin` from the axis; the push along the spring times its lever.
      const double foot = 0.4;
      const double pin = get("pin");
      const ArrayXd x = pin * (s.q - get("dead_centre")).cos();
      const ArrayXd y = pin * (s.q - get("dead_centre")).sin();
      const ArrayXd length = ((x - foot).square() + y.square()).sqrt();
      const ArrayXd volume = 1 - 0.4 * (1 - (length - (foot - pin)) / (2 * pin));
      const ArrayXd push = get("force") * volume.pow(-1.2);
      return -push * (x * y - y * (x - foot)) / length;
    }
    case HiddenEffect::kTimeDelay:
      return s.tau - s.earlier_tau;
    case HiddenEffect::kPeriodicDisturbance:
      return get("sine") * (get("frequency") * s.t).sin() +
             get("cosine") * (get("frequency") * s.t).cos();
    case HiddenEffect::kJointCoupling:
      if (has(h, "coefficient")) return get("coefficient") * s.other_v;
      return get("level") * s.other_v.sign();
    default:
      return friction_formula(h, base, s);
  }
}

class HiddenTruth : public testing::TestWithParam<HiddenEffect> {};

TEST_P(HiddenTruth, FormulaExplainsWhatIsAdded) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Request request{seed, {GetParam()}};
    request.duration_s = 4.0;
    const DrawnRobot drawn = draw_robot(request);
    const TrueEffect& hidden = drawn.truth.effects[0];
    const Robot base = test::baseline(request, drawn.truth);
    const Trace trace = test::trace_of(drawn, request);
    const double delay_s = hidden.effect == HiddenEffect::kTimeDelay ? value(hidden, "delay") : 0.0;
    const Signals s = signals(trace, hidden.joint, delay_s);
    const Eigen::VectorXd rest = test::unexplained(base, trace).col(hidden.joint);
    const Eigen::VectorXd wrong = rest - formula(hidden, drawn.robot, base, s).matrix();
    // Around a reversal a joint sticks, with any torque in between.
    const ArrayXd slides = (s.v.abs().min(s.other_v.abs()) > 0.06).cast<double>();
    const double left = test::rms((wrong.array() * slides).matrix());
    EXPECT_LT(left, 0.08 * test::rms((rest.array() * slides).matrix())) << "seed " << seed;
  }
}

// Two masses and play have no formula of the motor's motion: plant_test.cpp has their laws.
INSTANTIATE_TEST_SUITE_P(
    HiddenRobots, HiddenTruth,
    testing::Values(HiddenEffect::kCoulombFriction, HiddenEffect::kViscousFriction,
                    HiddenEffect::kQuadraticFriction, HiddenEffect::kStribeckFriction,
                    HiddenEffect::kFrictionAsymmetry, HiddenEffect::kLoadDependentFriction,
                    HiddenEffect::kHysteresis, HiddenEffect::kTorqueOffset,
                    HiddenEffect::kTorqueScale, HiddenEffect::kRotorInertia,
                    HiddenEffect::kLinkMass, HiddenEffect::kTipPayload,
                    HiddenEffect::kCoggingTorque, HiddenEffect::kJointStiffness,
                    HiddenEffect::kTimeDelay, HiddenEffect::kPeriodicDisturbance,
                    HiddenEffect::kJointCoupling, HiddenEffect::kTemperatureDrift,
                    HiddenEffect::kGearLoss, HiddenEffect::kPositionTorque),
    [](const auto& given) { return std::string(name(given.param)); });

// Added masses are those of the truth, in kg.
TEST(HiddenTruth, MassesAreAddedWhereTheTruthSays) {
  const Request link_request{5, {HiddenEffect::kLinkMass}};
  const DrawnRobot heavy = draw_robot(link_request), bare = draw_robot({5, {}});
  const auto link = static_cast<std::size_t>(heavy.truth.effects[0].joint);
  EXPECT_NEAR(heavy.robot.links[link].mass_kg - bare.robot.links[link].mass_kg,
              value(heavy.truth.effects[0], "mass"), 1e-12);
  EXPECT_EQ(heavy.robot.links[link].inertia_kg_m2, bare.robot.links[link].inertia_kg_m2);
  EXPECT_GT(value(heavy.truth.effects[0], "mass"), 0.12 * bare.robot.links[link].mass_kg);
  const DrawnRobot loaded = draw_robot({5, {HiddenEffect::kTipPayload}});
  EXPECT_EQ(loaded.robot.tip_mass_kg, value(loaded.truth.effects[0], "mass"));
  EXPECT_EQ(loaded.truth.effects[0].joint, 1);
}

}  // namespace
}  // namespace offnominal::sim::hidden
