#include <gtest/gtest.h>

#include <offnominal/model/effect_list.hpp>
#include <random>
#include <set>
#include <string>

#include "support/seed.hpp"

namespace offnominal::test {
namespace {

TEST(EffectList, EveryEffectHasItsOwnNumberAndName) {
  std::set<EffectKind> kinds;
  std::set<std::string> names;
  for (const EffectInfo& info : kAllEffectInfos) {
    EXPECT_TRUE(kinds.insert(info.kind).second) << info.name;
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_EQ(info_of(info.kind), &info);
    EXPECT_STRNE(info.formula, "");
  }
  for (const EffectInfo& info : kInfosOutsideChains) {
    EXPECT_TRUE(kinds.insert(info.kind).second) << info.name;
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_EQ(info_of(info.kind), &info);
  }
  EXPECT_EQ(kinds.size(), 22U);
}

TEST(EffectList, AChainMayHaveThoseOfTheListAndNoOther) {
  for (const EffectInfo& info : kAllEffectInfos) EXPECT_TRUE(chain_may_have(info.kind));
  for (const EffectInfo& info : kInfosOutsideChains) {
    EXPECT_FALSE(chain_may_have(info.kind)) << info.name;
    EXPECT_FALSE(parameters_valid(Effect<double>{info.kind, 0, {1, 1, 1, 1}})) << info.name;
  }
}

TEST(EffectList, AnEffectIsFoundByItsName) {
  for (const EffectInfo& info : kAllEffectInfos) EXPECT_EQ(info_named(info.name), &info);
  for (const EffectInfo& info : kInfosOutsideChains) EXPECT_EQ(info_named(info.name), &info);
  EXPECT_EQ(info_named("friction"), nullptr);
}

TEST(EffectList, EveryParameterHasARangeThatHoldsItsDefault) {
  for (const EffectInfo& info : kAllEffectInfos) {
    ASSERT_LE(info.parameters.size(), static_cast<std::size_t>(kMaxEffectParameters)) << info.name;
    std::set<std::string> names;
    for (const ParameterInfo& parameter : info.parameters) {
      EXPECT_TRUE(names.insert(parameter.name).second) << info.name << '.' << parameter.name;
      EXPECT_LT(parameter.min, parameter.max) << info.name << '.' << parameter.name;
      EXPECT_STRNE(parameter.meaning, "") << info.name << '.' << parameter.name;
      if (!parameter.required) {
        EXPECT_GE(parameter.default_value, parameter.min) << info.name << '.' << parameter.name;
        EXPECT_LE(parameter.default_value, parameter.max) << info.name << '.' << parameter.name;
      }
    }
  }
}

TEST(EffectList, ANumberThatIsNoEffectHasNoInfoAndIsNotVisited) {
  const auto unknown = static_cast<EffectKind>(200);
  EXPECT_EQ(info_of(unknown), nullptr);
  bool visited = false;
  EXPECT_FALSE(visit_effect(unknown, [&]<typename E>() { visited = true; }));
  EXPECT_FALSE(visited);
}

TEST(EffectList, VisitingGivesTheStructOfTheNumber) {
  for (const EffectInfo& info : kAllEffectInfos) {
    const char* name = "";
    EXPECT_TRUE(visit_effect(info.kind, [&]<typename E>() { name = E::kName; }));
    EXPECT_STREQ(name, info.name);
  }
}

// One and only one way to act, of those that effect.hpp lists.
TEST(EffectList, EveryEffectActsInOneWay) {
  using Parameters = std::array<double, kMaxEffectParameters>;
  for (const EffectInfo& info : kAllEffectInfos) {
    int ways = 0;
    visit_effect(info.kind, [&]<typename E>() {
      using At = JointInstant<double>;
      using Centre = std::array<double, 3>;
      ways += requires(Parameters p, At at) { E::torque(p, at); };
      ways += requires(Parameters p) { E::reflected_inertia(p); };
      ways += requires(Parameters p, Centre centre) { E::point_mass(p, centre); };
      ways += requires(Parameters p, At at) { E::friction_per_load(p, at); };
      ways += requires(Parameters p) { E::told_per_given(p); };
      ways += requires(Parameters p) { E::torque_of_state(p, 0.0); };
      ways += requires(Parameters p) { E::delay_s(p); };
    });
    EXPECT_EQ(ways, 1) << info.name;
  }
}

// What the struct's torque does at random instants, for random positive parameters.
struct Behaviour {
  bool acts_at_rest = false;
  bool counts_time = false;
  bool drives = false;  // is with the motion somewhere
};

template <typename E>
Behaviour behaviour(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> any(-2, 2);
  std::uniform_real_distribution<double> positive(0.1, 2);
  Behaviour seen;
  for (int i = 0; i < 200; ++i) {
    std::array<double, kMaxEffectParameters> p{};
    for (std::size_t k = 0; k < E::kParameters.size(); ++k) p[k] = positive(generator);
    if constexpr (requires { E::prepare(p, JointType::kRevolute); }) {
      E::prepare(p, JointType::kRevolute);
    }
    JointInstant<double> at{any(generator), any(generator), positive(generator), any(generator)};
    const double torque = E::torque(p, at);
    seen.drives = seen.drives || torque * at.dq < 0;
    JointInstant<double> later = at;
    later.time_s += 1;
    seen.counts_time = seen.counts_time || E::torque(p, later) != torque;
    at.dq = 0;
    at.source_dq = 0;
    seen.acts_at_rest = seen.acts_at_rest || E::torque(p, at) != 0;
  }
  return seen;
}

TEST(EffectTraits, SayWhatTheStructsTorqueDoes) {
  auto generator = seeded_generator();
  int torques = 0;
  for (const EffectInfo& info : kAllEffectInfos) {
    visit_effect(info.kind, [&]<typename E>() {
      if constexpr (detail::action_of<E>() == EffectAction::kTorque) {
        const Behaviour seen = behaviour<E>(generator);
        EXPECT_EQ(info.traits.acts_at_rest, seen.acts_at_rest) << info.name;
        EXPECT_EQ(info.traits.counts_time, seen.counts_time) << info.name;
        // With positive coefficients friction is against the motion, and what is not may be with
        // it.
        EXPECT_EQ(info.traits.is_friction, !seen.drives) << info.name;
        ++torques;
      }
    });
  }
  EXPECT_EQ(torques, 12);
}

TEST(EffectTraits, OnlyFrictionHasASignOfItsCoefficients) {
  for (const EffectInfo& info : kAllEffectInfos) {
    if (info.traits.sign != CoefficientSign::kEither || info.traits.part == FrictionPart::kDry) {
      EXPECT_TRUE(info.traits.is_friction) << info.name;
    }
  }
}

TEST(EffectTraits, SayOfEveryActionWhatFollowsFromIt) {
  EXPECT_TRUE(info_of(EffectKind::kTorqueScale)->acts_on_whole_drive());
  EXPECT_TRUE(info_of(EffectKind::kTimeDelay)->acts_on_whole_drive());
  EXPECT_FALSE(info_of(EffectKind::kLoadDependentFriction)->acts_on_whole_drive());
  EXPECT_TRUE(info_of(EffectKind::kTorqueScale)->is_known_quantity());
  EXPECT_TRUE(info_of(EffectKind::kTipPayload)->is_known_quantity());
  EXPECT_FALSE(info_of(EffectKind::kRotorInertia)->is_known_quantity());
  EXPECT_TRUE(info_of(EffectKind::kJointCoupling)->may_repeat());
  EXPECT_TRUE(info_of(EffectKind::kPeriodicDisturbance)->may_repeat());
  EXPECT_FALSE(info_of(EffectKind::kHysteresis)->may_repeat());
  EXPECT_EQ(info_of(EffectKind::kBacklash)->action, EffectAction::kDisplacement);
}

TEST(EffectList, GivenAFullListThenAddRefusesAndChangesNothing) {
  EffectList<double, 2> list;
  EXPECT_TRUE(list.add({EffectKind::kViscousFriction, 0, {1.0}}));
  EXPECT_TRUE(list.add({EffectKind::kTorqueOffset, 1, {2.0}}));
  EXPECT_FALSE(list.add({EffectKind::kTorqueOffset, 0, {3.0}}));
  ASSERT_EQ(list.view().size(), 2U);
  EXPECT_EQ(list.view()[1].kind, EffectKind::kTorqueOffset);
  EXPECT_EQ(list.view()[1].parameters[0], 2.0);
}

}  // namespace
}  // namespace offnominal::test
