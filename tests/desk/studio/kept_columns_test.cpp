// What was said of dropped files is there again for the next program that is given them.
#include "studio/kept_columns.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "desk/studio/strange_files.hpp"
#include "desk/support/temporary_folder.hpp"
#include "studio/intake.hpp"

namespace {

using nlohmann::ordered_json;
using offnominal::test::content_of;
using offnominal::test::put;
using offnominal::test::robot_text_of_arm;
using offnominal::test::strange_csv;
using offnominal::test::strange_positions;
using offnominal::test::strange_torques;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// A program, and its page.
class Program {
 public:
  explicit Program(const TemporaryFolder& folder, bool keeps = true)
      : intake_({.folder = folder.path(), .keeps_columns = keeps}) {}

  ordered_json give(const std::string& name, const std::string& content) {
    return intake_.take(intake_.folder().put(name, content));
  }
  Intake& operator()() { return intake_; }

 private:
  Intake intake_;
};

std::string text_in(const ordered_json& state) { return state.at("map").at("text"); }

std::string taken_up(const ordered_json& state) { return state.at("kept").at("taken_up"); }

TEST(KeptColumns, SaysTheMappingOfAProgramThatWasKilledAgain) {
  const TemporaryFolder folder;
  std::string text;
  ordered_json payload;
  // It goes behind the others: as one that was killed it has no last word.
  const auto killed = std::make_unique<Program>(folder);
  {
    killed->give("arm.toml", robot_text_of_arm());
    killed->give("run.csv", strange_csv(1));
    killed->give("more.csv", strange_csv(0.5));
    static_cast<void>((*killed)().set_signal({.quantity = "torque", .joint = 1, .scale = -1}));
    static_cast<void>(
        (*killed)().set_signal({.quantity = "velocity", .joint = 0, .source = std::string()}));
    static_cast<void>((*killed)().set_payload(1, Payload{0.5, {0, 0.1, 0}}));
    const ordered_json state = (*killed)().set_held_out(2, true);
    EXPECT_EQ(state.at("kept").at("file"), (folder / "studio_columns.json").string());
    EXPECT_EQ(state.at("kept").at("problem"), "");
    EXPECT_EQ(taken_up(state), "");
    text = text_in(state);
    payload = state.at("recordings").at(0).at("payload");
    std::filesystem::remove_all((*killed)().folder().path());
  }
  Program next(folder);
  // By other names, and in another order.
  next.give("another.csv", strange_csv(0.5));
  next.give("name.csv", strange_csv(1));
  const ordered_json state = next.give("robot.toml", robot_text_of_arm());
  EXPECT_EQ(text_in(state), text);
  EXPECT_EQ(taken_up(state), "the torque of joint 2, the velocity of joint 1");
  EXPECT_TRUE(state.at("recordings").at(0).at("held_out").get<bool>());
  EXPECT_FALSE(state.at("recordings").at(1).at("held_out").get<bool>());
  EXPECT_EQ(state.at("recordings").at(1).at("payload"), payload);
  // Forgotten, it does not come back.
  EXPECT_NE(text_in(next().guess_again()), text);
  EXPECT_EQ(taken_up(next().state()), "");
  static_cast<void>(next().set_held_out(1, false));
  Program third(folder);
  third.give("robot.toml", robot_text_of_arm());
  const ordered_json anew = third.give("run.csv", strange_csv(0.5));
  EXPECT_EQ(taken_up(anew), "");
  EXPECT_NE(text_in(anew), text);
  EXPECT_FALSE(anew.at("recordings").at(0).at("held_out").get<bool>());
}

TEST(KeptColumns, KeepTheMappingWhereARobotFileIsRefused) {
  const TemporaryFolder folder;
  Program program(folder);
  program.give("arm.toml", robot_text_of_arm());
  program.give("run.csv", strange_csv(1));
  const std::string text =
      text_in(program().set_signal({.quantity = "torque", .joint = 1, .scale = -1}));
  EXPECT_THROW(program.give("broken.toml", "joints = 3"), InputError);
  EXPECT_EQ(text_in(program().state()), text);
  // A robot that is put right is dropped in the place of the one before.
  EXPECT_EQ(text_in(program.give("arm.toml", robot_text_of_arm() + "# mended\n")), text);
}

TEST(KeptColumns, JoinFilesAsTheUserHadThem) {
  const TemporaryFolder folder;
  {
    Program program(folder);
    program.give("arm.toml", robot_text_of_arm());
    program.give("a.csv", strange_csv(1));
    program.give("b.csv", strange_csv(0.5));
    static_cast<void>(program().join(1, 2));
    static_cast<void>(program().set_signal({.quantity = "time", .file = 1, .offset_s = 2}));
    program.give("q.csv", strange_positions(1));
    program.give("i.csv", strange_torques(1));
    static_cast<void>(program().split(3));
  }
  Program next(folder);
  next.give("arm.toml", robot_text_of_arm());
  for (const auto& [name, content] :
       {std::pair{"a.csv", strange_csv(1)}, std::pair{"b.csv", strange_csv(0.5)},
        std::pair{"i.csv", strange_torques(1)}, std::pair{"q.csv", strange_positions(1)}}) {
    next.give(name, content);
  }
  std::vector<std::string> names;
  const ordered_json state = next().state();
  for (const ordered_json& one : state.at("recordings")) names.push_back(one.at("name"));
  EXPECT_THAT(names, ElementsAre("b.csv+a.csv", "i.csv", "q.csv"));
  EXPECT_EQ(taken_up(state), "the time of file 2");
}

TEST(KeptColumns, KeepWhatIsSaidOfHoldMaps) {
  const TemporaryFolder folder;
  for (const bool before : {true, false}) {
    Program program(folder);
    program.give("arm.toml", robot_text_of_arm());
    const ordered_json state = program.give("run.csv", strange_csv(1));
    EXPECT_EQ(state.at("map").at("at_rest").get<bool>(), !before);
    EXPECT_EQ(taken_up(state), before ? "" : "that they are readings at rest");
    static_cast<void>(program().set_at_rest(true));
  }
}

TEST(KeptColumns, AreNoOtherColumnsOrRobots) {
  const TemporaryFolder folder;
  {
    Program program(folder);
    program.give("arm.toml", robot_text_of_arm());
    program.give("run.csv", strange_csv(1));
    static_cast<void>(program().set_signal({.quantity = "torque", .joint = 1, .scale = -1}));
  }
  std::string renamed = strange_csv(1);
  renamed.replace(0, 4, "stamp");
  Program other(folder);
  other.give("arm.toml", robot_text_of_arm());
  EXPECT_EQ(taken_up(other.give("run.csv", renamed)), "");
  // And those of another program stay where this one writes.
  static_cast<void>(other().set_signal({.quantity = "torque", .joint = 0, .scale = -1}));
  Program first(folder);
  first.give("arm.toml", robot_text_of_arm());
  EXPECT_EQ(taken_up(first.give("run.csv", strange_csv(1))), "the torque of joint 2");
}

TEST(KeptColumns, LeaveAFileOfSomethingElseAloneAndSaySo) {
  for (const char* content : {"somebody's", "[]", "{}", "{\"offnominal_studio_columns\": 2}",
                              "{\"offnominal_studio_columns\": 1, \"columns\": 3}"}) {
    const TemporaryFolder folder;
    put(folder / "studio_columns.json", content);
    Program program(folder);
    program.give("arm.toml", robot_text_of_arm());
    program.give("run.csv", strange_csv(1));
    const ordered_json state =
        program().set_signal({.quantity = "torque", .joint = 1, .scale = -1});
    EXPECT_THAT(state.at("kept").at("problem").get<std::string>(), HasSubstr("studio_columns.json"))
        << content;
    EXPECT_EQ(content_of(folder / "studio_columns.json"), content);
    EXPECT_THAT(text_in(state), HasSubstr("scale = -1.0"));
  }
}

// A file of the right kind with nonsense in it takes nothing down.
TEST(KeptColumns, TakeNothingUpOfEntriesThatAreNone) {
  const TemporaryFolder folder;
  {
    Program program(folder);
    program.give("arm.toml", robot_text_of_arm());
    program.give("run.csv", strange_csv(1));
    static_cast<void>(program().set_payload(1, Payload{0.5, {0, 0, 0}}));
    static_cast<void>(program().set_signal({.quantity = "torque", .joint = 1, .scale = -1}));
  }
  const ordered_json good = ordered_json::parse(content_of(folder / "studio_columns.json"));
  const auto taken_with = [&](const char* kind, const ordered_json& said) {
    ordered_json bad = good;
    bad[kind][0]["said"] = said;
    put(folder / "studio_columns.json", bad.dump());
    Program program(folder);
    program.give("arm.toml", robot_text_of_arm());
    return program.give("run.csv", strange_csv(1));
  };
  ordered_json signal = good["columns"][0]["said"];
  signal["signals"][0]["joint"] = 0;
  ordered_json side = good["columns"][0]["said"];
  side["signals"][0]["of"] = 77;
  for (const ordered_json& said : {ordered_json(3), ordered_json::object(), signal, side}) {
    EXPECT_EQ(taken_up(taken_with("columns", said)), "") << said;
  }
  ordered_json payload = good["files"][0]["said"];
  payload["payload"]["mass_kg"] = -1;
  for (const ordered_json& said : {ordered_json(3), ordered_json::object(), payload}) {
    EXPECT_TRUE(taken_with("files", said).at("recordings").at(0).at("payload").is_null()) << said;
  }
}

TEST(KeptColumns, AreNeitherReadNorWrittenWhereNothingIsToBeKept) {
  const TemporaryFolder folder;
  Program program(folder, false);
  program.give("arm.toml", robot_text_of_arm());
  program.give("run.csv", strange_csv(1));
  const ordered_json state = program().set_signal({.quantity = "torque", .joint = 1, .scale = -1});
  EXPECT_EQ(state.at("kept").at("file"), "");
  EXPECT_FALSE(std::filesystem::exists(folder / "studio_columns.json"));
}

TEST(KeptColumns, KeepTheLastOfMany) {
  const TemporaryFolder folder;
  KeptColumns kept(folder / "a.json");
  for (std::size_t i = 0; i <= KeptColumns::kMost; ++i) {
    kept.keep_columns(std::to_string(i), {{"number", i}});
  }
  EXPECT_TRUE(kept.columns("0").is_null());
  EXPECT_EQ(kept.columns("1").at("number"), 1);
  EXPECT_EQ(kept.columns(std::to_string(KeptColumns::kMost)).at("number"), KeptColumns::kMost);
  kept.keep_columns("1", nullptr);
  EXPECT_TRUE(kept.columns("1").is_null());
}

TEST(ContentFingerprint, IsOfTheContentAloneAndOfItsEnds) {
  const TemporaryFolder folder;
  std::string text(3'000'000, 'x');
  put(folder / "a", text);
  put(folder / "b", text);
  EXPECT_EQ(content_fingerprint(folder / "a"), content_fingerprint(folder / "b"));
  text.back() = 'y';
  put(folder / "b", text);
  EXPECT_NE(content_fingerprint(folder / "a"), content_fingerprint(folder / "b"));
  put(folder / "empty", "");
  EXPECT_FALSE(content_fingerprint(folder / "empty").empty());
  EXPECT_TRUE(content_fingerprint(folder / "none").empty());
}

}  // namespace
