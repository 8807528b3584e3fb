#include <gtest/gtest.h>

#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <numbers>
#include <offnominal/model/forward_dynamics.hpp>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

KDL::Vector to_kdl(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

// KDL places a joint in the frame before it; its tip frame at q = 0 is this project's joint frame.
KDL::Segment to_kdl(const Joint<double>& joint, double rotor_inertia) {
  const auto& r = joint.rotation;
  const KDL::Rotation rotation(r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8]);
  const KDL::Vector origin = to_kdl(joint.origin_m);
  const auto type =
      joint.type == JointType::kRevolute ? KDL::Joint::RotAxis : KDL::Joint::TransAxis;
  const KDL::Joint moving(origin, rotation * to_kdl(joint.axis), type, 1, 0, rotor_inertia);
  const auto& [xx, yy, zz, xy, xz, yz] = joint.inertia_kg_m2;
  const KDL::RigidBodyInertia body(joint.mass_kg, to_kdl(joint.centre_of_mass_m),
                                   KDL::RotationalInertia(xx, yy, zz, xy, xz, yz));
  return KDL::Segment(moving, KDL::Frame(rotation, origin), body);
}

template <int N>
KDL::JntArray to_kdl(const Vector<N, double>& v) {
  KDL::JntArray array(N);
  array.data = v;
  return array;
}

struct Worst {
  double torque = 0;
  double inertia = 0;
  double gravity = 0;
  double coriolis = 0;
};

template <int N>
void compare_with_kdl(std::mt19937_64& generator, Worst& worst) {
  Chain<N, double> chain = random_chain<N, double>(generator);
  ASSERT_EQ(validate(chain), Status::kOk);
  KDL::Chain other;
  for (std::size_t i = 0; i < static_cast<std::size_t>(N); ++i) {
    const double rotor_inertia = uniform(generator, 0, 1);
    ASSERT_TRUE(chain.effects.add(
        {EffectKind::kRotorInertia, static_cast<std::uint8_t>(i), {rotor_inertia}}));
    other.addSegment(to_kdl(chain.joints[i], rotor_inertia));
  }
  const KDL::Vector gravity = to_kdl(chain.gravity_m_s2);
  const auto model = make_model(chain);
  const auto q = random_vector<N, double>(generator, std::numbers::pi);
  const auto dq = random_vector<N, double>(generator, 3.0);
  const auto ddq = random_vector<N, double>(generator, 5.0);
  const Vector<N, double> rest = Vector<N, double>::Zero();

  KDL::ChainIdSolver_RNE newton_euler(other, gravity);
  KDL::JntArray torque(N);
  const KDL::Wrenches no_wrenches(N);
  ASSERT_EQ(
      newton_euler.CartToJnt(to_kdl<N>(q), to_kdl<N>(dq), to_kdl<N>(ddq), no_wrenches, torque), 0);
  KDL::ChainDynParam parameters(other, gravity);
  KDL::JntSpaceInertiaMatrix inertia(N);
  KDL::JntArray weight(N);
  KDL::JntArray coriolis(N);
  ASSERT_EQ(parameters.JntToMass(to_kdl<N>(q), inertia), 0);
  ASSERT_EQ(parameters.JntToGravity(to_kdl<N>(q), weight), 0);
  ASSERT_EQ(parameters.JntToCoriolis(to_kdl<N>(q), to_kdl<N>(dq), coriolis), 0);

  const auto keep = [](double& largest, double value) { largest = std::max(largest, value); };
  const Vector<N, double> own_weight = bias_torque(model, q, rest, 0.0);
  const Vector<N, double> own_coriolis = bias_torque(model, q, dq, 0.0) - own_weight;
  keep(worst.torque, deviation(inverse_dynamics(model, q, dq, ddq, 0.0), torque.data));
  keep(worst.inertia, deviation(mass_matrix(model, q), inertia.data));
  keep(worst.gravity, deviation(own_weight, weight.data));
  keep(worst.coriolis, deviation(own_coriolis, coriolis.data));
}

template <int N>
void expect_agreement_with_kdl() {
  std::mt19937_64 generator = seeded_generator();
  Worst worst;
  for (int sample = 0; sample < 500; ++sample) compare_with_kdl<N>(generator, worst);
  EXPECT_LE(worst.torque, 1e-9);
  EXPECT_LE(worst.inertia, 1e-9);
  EXPECT_LE(worst.gravity, 1e-9);
  EXPECT_LE(worst.coriolis, 1e-9);
}

TEST(OrocosKdl, AgreesOnRandomChainsOfOneJoint) { expect_agreement_with_kdl<1>(); }
TEST(OrocosKdl, AgreesOnRandomChainsOfTwoJoints) { expect_agreement_with_kdl<2>(); }
TEST(OrocosKdl, AgreesOnRandomChainsOfSixJoints) { expect_agreement_with_kdl<6>(); }
TEST(OrocosKdl, AgreesOnRandomChainsOfSevenJoints) { expect_agreement_with_kdl<7>(); }

}  // namespace
}  // namespace offnominal::test
