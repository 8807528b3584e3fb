// What explain() says of a motion that shows little: one slow sine, one speed to and fro, a tiny
// range, a joint that stands.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>

#include "explain/explain.hpp"
#include "explain/link_share.hpp"
#include "hidden_case.hpp"

namespace offnominal::desk {
namespace {

namespace hidden = sim::hidden;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

hidden::Case poor_case(std::uint64_t seed, hidden::HiddenEffect effect) {
  hidden::Request request;
  request.seed = seed;
  request.effects = {effect};
  request.excitation = hidden::Excitation::kPoor;
  return hidden::make_case(request);
}

Explanation explained(const hidden::Case& made, double link_share) {
  ExplainOptions options;
  options.bootstrap_draws = 399;
  options.replays = 0;
  options.threads = 2;
  if (link_share > 0) options.link_share = link_share;
  return explain(test::to_robot(made.nominal), {test::to_log(made.recording)},
                 {test::to_log(made.holdout)}, options);
}

// Joint 1 stands, joint 2 hardly moves: masses and centres of mass go far off together, and a step
// that takes each for itself ends with a product of the two that is another torque.
TEST(PoorMotion, GIVEN_links_that_may_be_far_off_THEN_the_file_has_the_error_of_the_fit) {
  const auto made = poor_case(1734327441, hidden::HiddenEffect::kStribeckFriction);
  const Explanation told = explained(made, 0.6);
  for (const JointErrors& joint : told.joints) {
    EXPECT_LT(joint.rms_improved, 1.05 * joint.rms_before) << "joint " << joint.joint + 1;
    EXPECT_LT(joint.rms_improved, 1.3 * joint.rms_after) << "joint " << joint.joint + 1;
  }
}

// What holds a joint that stands is any torque within its friction.
TEST(PoorMotion, GIVEN_a_joint_that_stands_THEN_its_error_lets_no_link_off_the_file) {
  const auto made = poor_case(1734327441, hidden::HiddenEffect::kStribeckFriction);
  const Explanation told = explained(made, 0);
  EXPECT_FALSE(told.link_share_judged) << told.words;
  EXPECT_THAT(told.found, IsEmpty()) << told.words;
  EXPECT_THAT(told.shifts, IsEmpty()) << told.words;
}

TEST(PoorMotion, GIVEN_one_effect_that_the_models_numbers_nearly_take_THEN_it_is_told_beside_them) {
  const auto made = poor_case(1467287510, hidden::HiddenEffect::kCoulombFriction);
  const Explanation told = explained(made, 0);
  EXPECT_THAT(told.found, IsEmpty()) << told.words;
  ASSERT_THAT(told.ambiguous, SizeIs(1)) << told.words;
  ASSERT_THAT(told.ambiguous[0], SizeIs(1)) << told.words;
  EXPECT_EQ(told.ambiguous[0][0].name(), "coulomb_friction");
  EXPECT_EQ(told.ambiguous[0][0].joint, 1);
  EXPECT_THAT(told.words, HasSubstr("or the model's own numbers"));
  EXPECT_THAT(told.advice, ::testing::Contains(HasSubstr("--excite coulomb_friction@2")));
}

// A wave in time does on one sine what friction does.
TEST(PoorMotion, GIVEN_friction_that_a_wave_could_be_THEN_no_wave_is_in_its_class) {
  const auto made = poor_case(1546668349, hidden::HiddenEffect::kViscousFriction);
  const Explanation told = explained(made, 0);
  ASSERT_THAT(told.ambiguous, SizeIs(1)) << told.words;
  EXPECT_TRUE(holds_in_any(told.ambiguous, {EffectKind::kViscousFriction, 0})) << told.words;
  EXPECT_FALSE(holds_in_any(told.ambiguous, {EffectKind::kPeriodicDisturbance, 0})) << told.words;
}

// What fits a curve over the position on a short range may be any such curve.
TEST(PoorMotion,
     GIVEN_a_ripple_longer_than_the_range_THEN_a_torque_over_the_position_is_as_likely) {
  const auto made = poor_case(899444813, hidden::HiddenEffect::kPositionTorque);
  const Explanation told = explained(made, 0);
  ASSERT_THAT(told.ambiguous, SizeIs(1)) << told.words;
  EXPECT_TRUE(holds_in_any(told.ambiguous, {EffectKind::kPositionTorque, 0})) << told.words;
}

}  // namespace
}  // namespace offnominal::desk
