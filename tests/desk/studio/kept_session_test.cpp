#include "studio/kept_session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "common/refused.hpp"
#include "desk/studio/studio_input.hpp"
#include "desk/support/temporary_folder.hpp"
#include "studio/session.hpp"

namespace {

using nlohmann::ordered_json;
using offnominal::test::content_of;
using offnominal::test::studio_input;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;
using ::testing::HasSubstr;

class StudioKeptSession : public ::testing::Test {
 protected:
  TemporaryFolder folder_;

  [[nodiscard]] Input input(bool hold_out = true) const {
    Input made = studio_input(folder_ / "arm.toml", hold_out);
    made.keep_beside = folder_ / "a.csv";
    return made;
  }
  [[nodiscard]] std::string file(const std::string& name = "a.studio.json") const {
    return (folder_ / name).string();
  }
  void put(const std::string& name, const std::string& text) const {
    std::ofstream(file(name)) << text;
  }
};

TEST_F(StudioKeptSession, IsTakenUpByTheNextProgram) {
  ordered_json before;
  {
    Session session(input());
    EXPECT_FALSE(std::filesystem::exists(file()));
    session.add("viscous_friction", 2);
    session.add("coulomb_friction", 2);
    before = session.state();
    EXPECT_EQ(before.at("kept").at("file"), file());
  }  // as if it had been killed: nothing is written at the end
  Session again(input());
  const ordered_json after = again.state();
  EXPECT_EQ(after.at("kept").at("taken_up"), 2);
  ASSERT_EQ(after.at("steps").size(), 2U);
  for (const char* part : {"parameters", "before", "after", "refitted"}) {
    EXPECT_EQ(after.at("steps").at(1).at(part), before.at("steps").at(1).at(part)) << part;
  }
  EXPECT_EQ(after.at("joints"), before.at("joints"));
}

// Also within one program: a page that is loaded again begins where it was.
TEST_F(StudioKeptSession, BeginsWhereThePageWas) {
  const View view{.joint = 1, .recording = 1, .from_s = 0.5, .to_s = 1.25, .beside = 0};
  const ordered_json told = {
      {"joint", 2}, {"recording", 2}, {"beside", 1}, {"from", 0.5}, {"to", 1.25}};
  {
    Session session(input());
    EXPECT_EQ(session.state().at("look"), nullptr);
    session.look_at(view);
    EXPECT_EQ(session.state().at("look"), told);
    EXPECT_FALSE(std::filesystem::exists(file())) << "whoever only looks leaves nothing";
    session.add("viscous_friction", 2);
  }
  EXPECT_EQ(Session(input()).state().at("look"), told);
  {
    Session session(input());
    session.look_at({});
  }
  EXPECT_EQ(Session(input()).state().at("look").at("joint"), 1);
}

TEST_F(StudioKeptSession, RefusesToLookAtWhatIsNotThere) {
  Session session(input());
  EXPECT_THROW(session.look_at({.joint = 2}), Refused);
  EXPECT_THROW(session.look_at({.recording = 2}), Refused);
  EXPECT_THROW(session.look_at(view_from({{"joint", 0},
                                          {"recording", 1},
                                          {"beside", nullptr},
                                          {"from", nullptr},
                                          {"to", nullptr}})),
               Refused);
  session.add("viscous_friction", 2);
  ordered_json kept = ordered_json::parse(content_of(file()));
  kept["look"] = {{"joint", 9}, {"recording", 1}, {"beside", nullptr}, {"from", 0}, {"to", 1}};
  put("a.studio.json", kept.dump());
  EXPECT_EQ(Session(input()).state().at("look"), nullptr);
  kept["look"] = "here";
  put("a.studio.json", kept.dump());
  EXPECT_EQ(Session(input()).state().at("kept").at("taken_up"), 0) << "no file of ours";
}

TEST_F(StudioKeptSession, KeepsTheAnswerOfTheSearch) {
  ordered_json answer;
  {
    Session session(input());
    session.add("viscous_friction", 2);
    session.start_to_explain();
    do {
      answer = session.explanation();
    } while (answer.at("state") == "running");
    ASSERT_EQ(answer.at("state"), "done");
    ASSERT_EQ(answer.at("answer").at("joints").at(0).at("cards").size(), 1U);
    EXPECT_EQ(answer.at("answer").at("joints").at(0).at("cards").at(0).at("finding"), 0);
    EXPECT_EQ(answer.at("search"), 1);
    EXPECT_NO_THROW(static_cast<void>(session.evidence_of_finding(1, 0)));
    EXPECT_ANY_THROW(static_cast<void>(session.evidence_of_finding(2, 0)));
  }
  Session again(input());
  ordered_json kept = again.explanation();
  EXPECT_EQ(kept.at("revision"), again.state().at("revision"));
  // What its picture is drawn from is not kept.
  EXPECT_EQ(kept.at("answer").at("joints").at(0).at("cards").at(0).at("finding"), nullptr);
  EXPECT_EQ(kept.at("answer").at("words"), answer.at("answer").at("words"));
  again.add("coulomb_friction", 2);
  EXPECT_NE(again.explanation().at("revision"), again.state().at("revision"));
  Session third(input());
  EXPECT_NE(third.explanation().at("revision"), third.state().at("revision"));
}

TEST_F(StudioKeptSession, BeginsAnewWhenItIsToldTo) {
  {
    Session session(input());
    session.add("viscous_friction", 2);
  }
  {
    Session session(input());
    const ordered_json state = session.undo_all();
    EXPECT_TRUE(state.at("steps").empty());
    EXPECT_EQ(state.at("kept").at("taken_up"), 0);
  }
  EXPECT_TRUE(Session(input()).state().at("steps").empty());
}

TEST_F(StudioKeptSession, LeavesTheFilesOfOthersAlone) {
  put("a.studio.json", "my own notes");
  {
    Session session(input());
    session.add("viscous_friction", 2);
  }
  // Other recordings beside the same name.
  {
    Session other(input(false));
    EXPECT_TRUE(other.state().at("steps").empty());
    other.add("coulomb_friction", 2);
  }
  EXPECT_EQ(content_of(file()), "my own notes");
  EXPECT_EQ(Session(input()).state().at("steps").at(0).at("effect"), "viscous_friction");
  EXPECT_EQ(Session(input(false)).state().at("steps").at(0).at("effect"), "coulomb_friction");
  EXPECT_TRUE(std::filesystem::exists(file("a.studio_3.json")));
  EXPECT_EQ(Session(input()).state().at("kept").at("not_taken_up"), "")
      << "the session is there: somebody's notes beside it are no loss";
}

TEST_F(StudioKeptSession, TakesUpNothingThatIsDamaged) {
  {
    Session session(input());
    session.add("viscous_friction", 2);
  }
  const std::string whole = content_of(file());
  for (const std::string& text :
       {std::string(), whole.substr(0, whole.size() / 2), std::string("[1, 2]"),
        std::string(R"({"offnominal_studio_session": "1"})")}) {
    put("a.studio.json", text);
    Session session(input());
    EXPECT_TRUE(session.state().at("steps").empty()) << text;
    const ordered_json kept = session.state().at("kept");
    EXPECT_THAT(kept.at("not_taken_up").get<std::string>(),
                HasSubstr("a.studio.json is empty, cut off or no session"))
        << text;
    EXPECT_EQ(kept.at("file"), file("a.studio_2.json"));
    EXPECT_EQ(content_of(file()), text) << "whose it is nobody can tell";
  }
}

TEST_F(StudioKeptSession, TakesUpWhatItKnowsOfAnotherVersion) {
  {
    Session session(input());
    session.add("viscous_friction", 2);
    session.add("coulomb_friction", 2);
  }
  ordered_json kept = ordered_json::parse(content_of(file()));
  kept["steps"][1]["effect"] = "friction_of_next_year";
  put("a.studio.json", kept.dump());
  const std::string whole = content_of(file());
  {
    Session session(input());
    EXPECT_EQ(session.state().at("steps").size(), 1U);
    EXPECT_NE(session.state().at("kept").at("not_taken_up"), "");
    session.add("torque_offset", 1);  // which writes the file anew
    EXPECT_EQ(content_of(file("a.studio.json.before")), whole);
    EXPECT_EQ(session.undo_all().at("kept").at("not_taken_up"), "");
  }
  kept["steps"][0]["joint"] = 77;
  put("a.studio.json", kept.dump());
  EXPECT_TRUE(Session(input()).state().at("steps").empty());
}

TEST_F(StudioKeptSession, SaysWhyItIsNotKept) {
  Input lost = input();
  lost.keep_beside = folder_ / "no such folder" / "a.csv";
  Session session(std::move(lost));
  const ordered_json state = session.add("viscous_friction", 2);
  EXPECT_EQ(state.at("steps").size(), 1U);
  EXPECT_THAT(state.at("kept").at("problem").get<std::string>(), HasSubstr("no such folder"));
}

TEST_F(StudioKeptSession, IsOfTheNumbersAndNotOfTheNames) {
  const Input first = input();
  Input second = input();
  second.log_files = {"elsewhere.csv"};
  second.robot_file = "elsewhere.toml";
  EXPECT_EQ(fingerprint_of(first), fingerprint_of(second));
  second.robot.joints[0].joint.mass_kg += 1e-9;
  EXPECT_NE(fingerprint_of(first), fingerprint_of(second));
  EXPECT_NE(fingerprint_of(first), fingerprint_of(input(false)));
}

}  // namespace
