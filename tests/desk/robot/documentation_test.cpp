#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <offnominal/controller/fault.hpp>
#include <offnominal/model/effect_list.hpp>
#include <offnominal/status.hpp>
#include <set>
#include <string>

#include "common/file.hpp"
#include "common/number.hpp"
#include "robot/friction_sign.hpp"
#include "robot/read_effect.hpp"
#include "robot/read_joint.hpp"
#include "robot/read_settings.hpp"
#include "robot/robot_file.hpp"
#include "robot/transmission.hpp"
#include "support/places.hpp"

// The documents say what the code does: every status, effect, parameter and key has its place.

namespace offnominal::desk {
namespace {

using testing::HasSubstr;

std::string document(const std::string& name) {
  return read_text_file(test::source_dir() / "docs" / name);
}

// What stands between a heading and the next one; empty where there is no such heading.
std::string paragraph_below(const std::string& text, const std::string& heading) {
  const auto at = text.find("\n" + heading + "\n\n");
  if (at == std::string::npos) return {};
  const auto begin = at + heading.size() + 3;
  return text.substr(begin, text.find("\n#", begin) - begin);
}

TEST(Troubleshooting, HasAParagraphForEveryStatusAndNoOther) {
  const std::string text = document("troubleshooting.md");
  std::set<std::string> headings;
  for (int number = 0; number <= std::numeric_limits<std::uint8_t>::max(); ++number) {
    // One space of numbers for the core, the bus and the controller.
    const std::string name =
        number == 0 ? name_of(Status::kOk) : name_of(static_cast<controller::Fault>(number));
    if (name == "Unknown") continue;
    const std::string heading = "### " + std::to_string(number) + " " + name;
    headings.insert(heading);
    EXPECT_GT(paragraph_below(text, heading).size(), 20U)
        << "docs/troubleshooting.md needs a paragraph below \"" << heading << "\"";
  }
  for (auto at = text.find("\n### "); at != std::string::npos; at = text.find("\n### ", at + 1)) {
    const std::string heading = text.substr(at + 1, text.find('\n', at + 1) - at - 1);
    EXPECT_TRUE(headings.contains(heading)) << heading << " is no status";
  }
}

// docs/README.md has a line for every page and for nothing else, and the README leads to it.
TEST(Documents, StandInTheirIndex) {
  const std::string index = document("README.md");
  std::set<std::string> pages;
  for (const auto& entry : std::filesystem::directory_iterator(test::source_dir() / "docs")) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() != ".md" || name == "README.md") continue;
    pages.insert(name);
    EXPECT_THAT(index, HasSubstr("\n| [" + name + "](" + name + ") | "))
        << "docs/README.md needs a row for it";
  }
  EXPECT_GT(pages.size(), 20U);
  const std::string row = "\n| [";
  for (auto at = index.find(row); at != std::string::npos; at = index.find(row, at + 1)) {
    const auto begin = at + row.size();
    const std::string name = index.substr(begin, index.find(']', begin) - begin);
    EXPECT_TRUE(pages.contains(name)) << name << " is no page";
  }
  EXPECT_THAT(read_text_file(test::source_dir() / "README.md"), HasSubstr("](docs/README.md)"));
}

// Whatever is built of apps/ is known to the page that says what lies where.
TEST(Architecture, KnowsEveryProgram) {
  const std::string text = document("architecture.md");
  for (const auto& entry : std::filesystem::directory_iterator(test::source_dir() / "apps")) {
    if (!entry.is_directory()) continue;
    EXPECT_THAT(text, HasSubstr("`" + entry.path().filename().string() + "`"));
  }
}

std::string parameter_row(const EffectTraits& traits, const ParameterInfo& parameter) {
  std::string allowed = takes_energy_out(traits, parameter) ? ">= 0" : "any";
  if (parameter.min > -effects::kAny) allowed = ">= " + shortest(parameter.min);
  if (parameter.max < effects::kAny) allowed += " <= " + shortest(parameter.max);
  const std::string otherwise = parameter.required ? "required" : shortest(parameter.default_value);
  return "| `" + std::string(parameter.name) + "` | " +
         unit_of(parameter.quantity, JointType::kRevolute) + " | " +
         unit_of(parameter.quantity, JointType::kPrismatic) + " | " + allowed + " | " + otherwise +
         " | " + parameter.meaning + " |\n";
}

TEST(RobotFileDocument, HasEveryEffectWithItsFormulaAndParameters) {
  const std::string text = document("robot-file.md");
  for (const EffectInfo* info : file_effects()) {
    const std::string section = paragraph_below(text, "### " + std::string(info->name)) + "\n";
    ASSERT_NE(section, "\n") << "docs/robot-file.md needs a section ### " << info->name;
    EXPECT_THAT(section, HasSubstr("    " + std::string(info->formula) + "\n")) << info->name;
    for (const ParameterInfo& parameter : info->parameters) {
      EXPECT_THAT(section, HasSubstr(parameter_row(info->traits, parameter))) << info->name;
    }
  }
}

TEST(ExplainDocument, HasARowForEveryEffectAndNoOther) {
  std::string rows;
  const auto add = [&](const EffectInfo& info) {
    rows +=
        std::string("| `") + info.name + "` | " + info.words + " | " + info.motion_hint + " |\n";
  };
  for (const EffectInfo* info : file_effects()) add(*info);
  EXPECT_THAT(document("explain.md"),
              HasSubstr("| effect | what it is | the motion that shows it best |\n|---|---|---|\n" +
                        rows + "\n"));
}

TEST(RobotFileDocument, HasEveryKey) {
  const std::string text = document("robot-file.md");
  for (const auto& keys : {joint_keys(), effect_keys(), estimator_keys(), arming_keys(),
                           bound_keys(), transmission_keys()}) {
    for (const std::string& key : keys) {
      EXPECT_THAT(text, HasSubstr("\n| `" + key + "` |")) << key;
    }
  }
}

TEST(RobotFileDocument, HasAnExampleThatIsAccepted) {
  const std::string text = document("robot-file.md");
  const std::string fence = "```toml\n";
  const auto begin = text.find(fence);
  ASSERT_NE(begin, std::string::npos);
  const auto end = text.find("\n```", begin);
  const auto robot =
      parse_robot(text.substr(begin + fence.size(), end - begin - fence.size()), "example");
  EXPECT_EQ(robot.name, "pendulum");
}

TEST(EffectParameters, DoNotCollideWithTheOtherKeysOfAnEffect) {
  for (const EffectInfo* info : file_effects()) {
    for (const ParameterInfo& parameter : info->parameters) {
      const std::string name = parameter.name;
      EXPECT_TRUE(name != "kind" && name != "joint" && name != "motor" && name != "fitted" &&
                  name != "source")
          << info->name << "." << name;
    }
  }
}

}  // namespace
}  // namespace offnominal::desk
