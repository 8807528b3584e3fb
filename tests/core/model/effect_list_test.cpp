#include <gtest/gtest.h>

#include <offnominal/model/effect_list.hpp>
#include <set>
#include <string>

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
  EXPECT_EQ(kinds.size(), 18U);
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
