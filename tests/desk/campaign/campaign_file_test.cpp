#include "campaign/campaign_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "common/error.hpp"
#include "desk/campaign/small_campaign.hpp"

namespace offnominal::desk::campaign {
namespace {

using test::campaign_of;
using test::small_campaign;
using testing::AllOf;
using testing::HasSubstr;

std::string refusal_of(const std::string& text) {
  try {
    static_cast<void>(campaign_of(text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  if (at == std::string::npos) throw std::logic_error("not there: " + what);
  return text.replace(at, what.size(), by);
}

TEST(CampaignFile, NumbersEveryRunOfEveryFaultOnce) {
  const Campaign campaign = campaign_of(small_campaign());
  ASSERT_EQ(campaign.faults.size(), 4U);  // two joints, two sizes
  EXPECT_EQ(campaign.run_count(), 4 * 2 + 3);
  EXPECT_EQ(run_of(campaign, 0).fault, &campaign.faults[0]);
  EXPECT_EQ(run_of(campaign, 7).fault, &campaign.faults[3]);
  EXPECT_EQ(run_of(campaign, 8).fault, nullptr);
  EXPECT_EQ(campaign.faults[2].joint, 1);
  EXPECT_EQ(campaign.faults[2].size, 0.2);
}

TEST(CampaignFile, DividesAllRunsAmongShards) {
  const Campaign campaign = campaign_of(small_campaign());
  std::set<std::int64_t> all;
  for (int i = 1; i <= 8; ++i) {
    for (const std::int64_t number : runs_of(campaign, parse_shard(std::to_string(i) + "/8"))) {
      EXPECT_TRUE(all.insert(number).second) << number;
    }
  }
  EXPECT_EQ(static_cast<std::int64_t>(all.size()), campaign.run_count());
  for (const char* wrong : {"", "0/3", "4/3", "1", "1/", "a/b", "1/2/3", "1/9999999"}) {
    EXPECT_THROW(static_cast<void>(parse_shard(wrong)), InputError) << wrong;
  }
}

TEST(CampaignFile, HasAModelThatIsOffByWhatTheFileSays) {
  const Campaign campaign = campaign_of(small_campaign());
  for (std::size_t i = 0; i < 2; ++i) {
    const double share =
        campaign.model.joints[i].joint.mass_kg / campaign.truth.joints[i].joint.mass_kg - 1;
    EXPECT_NE(share, 0);
    EXPECT_LE(std::abs(share), 0.03);
  }
}

TEST(CampaignFile, IsTheSameWhateverItsCommentsAndOrder) {
  const Campaign one = campaign_of(small_campaign());
  const Campaign other = campaign_of("# a comment\n" + small_campaign("\n# and one more\n"));
  EXPECT_EQ(one.identity, other.identity);
  EXPECT_NE(one.identity, campaign_of(replaced(small_campaign(), "seed = 7", "seed = 8")).identity);
}

TEST(CampaignFile, RefusesWhatIsWrongWithFileLineFoundAllowedAndMend) {
  const std::string good = small_campaign();
  EXPECT_THAT(refusal_of(replaced(good, "seed = 7", "sede = 7")),
              AllOf(HasSubstr("campaign.toml"), HasSubstr("line 4"), HasSubstr("sede")));
  EXPECT_THAT(refusal_of(replaced(good, "seed = 7", "seed = \"x\"")), HasSubstr("seed"));
  EXPECT_THAT(refusal_of(replaced(good, "joint = \"each\"", "joint = 9")),
              AllOf(HasSubstr("fault[1].joint"), HasSubstr("found 9"), HasSubstr("1 to 2")));
  EXPECT_THAT(refusal_of(replaced(good, "joint = \"each\"", "joint = \"all\"")), HasSubstr("each"));
  EXPECT_THAT(refusal_of(replaced(good, "kind = \"offset\"", "kind = \"ofset\"")),
              HasSubstr("encoder_jump"));
  EXPECT_THAT(refusal_of(replaced(good, "sizes = [0.2, 8.0]", "sizes = [0.2, 0.2]")),
              HasSubstr("one size twice"));
  EXPECT_THAT(refusal_of(replaced(good, "fault_s = 0.8", "fault_s = 2.0")),
              HasSubstr("below duration_s"));
  EXPECT_THAT(
      refusal_of(replaced(good, "cad_error",
                          "robot = \"" + (test::kRobots / "emps.toml").string() + "\"\ncad_error")),
      AllOf(HasSubstr("a plant of 1 joints"), HasSubstr("2 joints")));
  EXPECT_THAT(refusal_of(replaced(good, "[[detector]]\nkind = \"torque\"",
                                  "[motion]\nmiddles_rad = [6.0, 0.0]\n[[detector]]\nkind = "
                                  "\"torque\"")),
              AllOf(HasSubstr("joint 1"), HasSubstr("limits of position")));
  EXPECT_THAT(
      refusal_of(small_campaign("[[fault]]\nkind = \"push\"\nlink = 2\nsizes = [5.0]\n", "robot")),
      HasSubstr("mujoco"));
  EXPECT_THAT(refusal_of(small_campaign("[[fault]]\nkind = \"locked\"\njoint = 1\nsizes = [1.0]")),
              HasSubstr("locked does not have"));
  EXPECT_THAT(refusal_of(small_campaign("[[fault]]\nkind = \"friction_share\"\njoint = 1\n"
                                        "sizes = [1.0]")),
              HasSubstr("without Coulomb friction"));
  EXPECT_THAT(refusal_of(small_campaign("[[detector]]\nkind = \"torque\"")),
              HasSubstr("a second detector called torque 10"));
  const auto accommodating = [&](const std::string& kind) {
    return replaced(good, "kind = \"" + kind + "\"\n",
                    "kind = \"" + kind + "\"\naccommodates = true\n");
  };
  EXPECT_THAT(refusal_of(accommodating("kdl")), HasSubstr("kind = \"torque\" alone"));
  EXPECT_THAT(refusal_of(accommodating("torque")),
              AllOf(HasSubstr("known afterwards"), HasSubstr("observed")));
}

TEST(CampaignFile, OfObservedVelocitiesHasNoFaultBeforeTheyHaveSettled) {
  const std::string observed = replaced(small_campaign(""), "period_s = 0.002\n",
                                        "period_s = 0.002\nvelocity = \"observed\"\n");
  EXPECT_EQ(campaign_of(observed).plant.velocity, VelocityKind::kObserved);
  const auto beginning = [&](const std::string& fault_s) {
    return replaced(observed, "fault_s = 0.8", "fault_s = " + fault_s);
  };
  EXPECT_THAT(refusal_of(beginning("0.09")), AllOf(HasSubstr("fault_s"), HasSubstr("settled")));
  EXPECT_NO_THROW(static_cast<void>(campaign_of(beginning("0.1"))));
  const std::string sent = replaced(observed, "\"observed\"", "\"sent\"");
  EXPECT_NO_THROW(
      static_cast<void>(campaign_of(replaced(sent, "fault_s = 0.8", "fault_s = 0.09"))));
}

TEST(CampaignFile, OfASecondFilterHasItsPoleOfTheMonitorAlone) {
  const std::string good = small_campaign("");
  const auto with_filter = [&](const std::string& kind, const std::string& pole) {
    return replaced(good, "kind = \"" + kind + "\"\n",
                    "kind = \"" + kind + "\"\nfast_alpha_per_s = " + pole + "\n");
  };
  EXPECT_THAT(refusal_of(with_filter("kdl", "50.0")), HasSubstr("kind = \"torque\" alone"));
  EXPECT_THAT(refusal_of(with_filter("torque", "1.0")),
              HasSubstr("above alpha_per_s, which is 10"));
  EXPECT_EQ(refusal_of(with_filter("torque", "50.0")), "nothing was refused");
}

}  // namespace
}  // namespace offnominal::desk::campaign
