// Recordings of several files that the page is given: which go together, and what is read of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/refused.hpp"
#include "desk/studio/loading.hpp"
#include "desk/studio/served_studio.hpp"
#include "desk/studio/strange_files.hpp"
#include "log/read_log.hpp"
#include "robot/channels.hpp"
#include "robot/payload.hpp"
#include "studio/file_groups.hpp"
#include "studio/intake.hpp"

namespace {

using nlohmann::json;
using nlohmann::ordered_json;
using offnominal::test::arm_description;
using offnominal::test::Loading;
using offnominal::test::open_files;
using offnominal::test::put;
using offnominal::test::robot_text_of_arm;
using offnominal::test::ServedStudio;
using offnominal::test::strange_csv;
using offnominal::test::strange_positions;
using offnominal::test::strange_torques;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr SignalsIn kPositions{true, false, false};
constexpr SignalsIn kVelocities{false, true, false};
constexpr SignalsIn kTorques{false, false, true};
constexpr SignalsIn kAll{true, true, true};
constexpr SignalsIn kNothing{};

using Groups = std::vector<std::vector<std::size_t>>;

TEST(FileGroups, PutPositionsFirstAndWhatIsMissingBehindThem) {
  EXPECT_EQ(groups_of({{"i.csv", kTorques}, {"q.csv", kPositions}}), (Groups{{1, 0}}));
  EXPECT_EQ(groups_of({{"v.csv", kVelocities}, {"i.csv", kTorques}, {"q.csv", kPositions}}),
            (Groups{{2, 0, 1}}));
  EXPECT_EQ(words_of({{"q.csv", kPositions}, {"i.csv", {false, true, true}}}),
            "positions in q.csv, velocities, torques in i.csv");
}

TEST(FileGroups, LeaveAloneWhatIsWholeOrWouldBeThereTwice) {
  EXPECT_EQ(groups_of({{"a.csv", kAll}, {"b.csv", kAll}}), (Groups{{0}, {1}}));
  EXPECT_EQ(groups_of({{"a.csv", kAll}, {"b.csv", kTorques}}), (Groups{{0}, {1}}));
  EXPECT_EQ(groups_of({{"a.csv", kTorques}, {"b.csv", kTorques}}), (Groups{{0}, {1}}));
  EXPECT_EQ(groups_of({{"a.csv", kPositions}, {"b.csv", kNothing}}), (Groups{{0}, {1}}));
  // Torques of one of two alone.
  EXPECT_EQ(groups_of({{"q.csv", kPositions}, {"i.csv", kTorques}, {"j.csv", kTorques}}),
            (Groups{{0, 1}, {2}}));
  EXPECT_EQ(groups_of({}), Groups{});
}

TEST(FileGroups, GoByTheNamesWhereThereAreSeveral) {
  EXPECT_EQ(groups_of({{"slow_q.csv", kPositions},
                       {"fast_i.csv", kTorques},
                       {"fast_q.csv", kPositions},
                       {"slow_i.csv", kTorques}}),
            (Groups{{0, 3}, {2, 1}}));
  EXPECT_EQ(groups_of({{"pos_2.csv", kPositions},
                       {"pos_1.csv", kPositions},
                       {"cur_1.csv", kTorques},
                       {"cur_2.csv", kTorques}}),
            (Groups{{0, 3}, {1, 2}}));
}

TEST(FileGroups, KnowTheSignalsOfAFileByItsNamesOrTheRobotsChannels) {
  RobotDescription robot = arm_description();
  NamedColumns columns;
  columns.names = {"t", "q1", "q2", "foo", "bar"};
  for (const std::string& name : columns.names) {
    columns.columns[name] = Eigen::VectorXd::LinSpaced(20, 0, 1);
  }
  EXPECT_TRUE(signals_in(columns, robot).position);
  EXPECT_FALSE(signals_in(columns, robot).torque);
  robot.channels = ChannelMap{};
  robot.channels->torque.resize(2);
  robot.channels->torque[0].source = "2:foo";
  robot.channels->torque[1].source = "2:bar";
  EXPECT_FALSE(signals_in(columns, robot).position);
  EXPECT_TRUE(signals_in(columns, robot).torque);
  robot.channels.reset();
  columns.has_names = false;
  EXPECT_FALSE(signals_in(columns, robot).position);
}

std::vector<std::string> names_in(const ordered_json& state) {
  std::vector<std::string> names;
  for (const ordered_json& one : state.at("recordings")) names.push_back(one.at("name"));
  return names;
}

const ordered_json& signal_at(const ordered_json& state, std::size_t at) {
  return state.at("map").at("signals").at(at);
}

TEST_F(Loading, JoinsFilesThatHaveEachWhatTheOtherLacksInWhicheverOrderTheyCome) {
  give("torques.csv", strange_torques(1));
  give("positions.csv", strange_positions(1));
  EXPECT_THAT(names_in(intake_.state()), ElementsAre("torques.csv", "positions.csv"))
      << "which robot's is not known";
  const ordered_json state = give("arm.toml", robot_text_of_arm());
  ASSERT_THAT(names_in(state), ElementsAre("positions.csv+torques.csv"));
  const ordered_json& recording = state.at("recordings").at(0);
  EXPECT_EQ(recording.at("files").at(1).at("name"), "torques.csv");
  EXPECT_EQ(recording.at("bytes"), recording.at("files").at(0).at("bytes").get<int>() +
                                       recording.at("files").at(1).at("bytes").get<int>());
  EXPECT_EQ(recording.at("why_joined"),
            "positions, velocities in positions.csv, torques in torques.csv");
  // The times of both files come first.
  EXPECT_EQ(signal_at(state, 0).at("file"), 1);
  EXPECT_EQ(signal_at(state, 1).at("file"), 2);
  EXPECT_EQ(signal_at(state, 1).at("source"), "time");
  EXPECT_EQ(state.at("map").at("columns_of_files").at(1).size(), 3U);
  EXPECT_EQ(state.at("map").at("columns").at(0), "1:time");
  EXPECT_EQ(state.at("map").at("columns").at(1), "actual_pos_1");
}

// As read_log() reads the same files by the [channels] that are written.
TEST_F(Loading, ReadsSeveralFilesAsEveryVerbDoes) {
  give("arm.toml", robot_text_of_arm());
  give("positions.csv", strange_positions(1));
  give("torques.csv", strange_torques(1));
  static_cast<void>(intake_.set_signal({.quantity = "torque", .joint = 1, .scale = -1}));
  static_cast<void>(intake_.set_payload(1, Payload{0.1, {0, 0, 0}}));
  const ordered_json preview = intake_.preview(1, 200);
  ASSERT_TRUE(preview.at("error").is_null()) << preview.at("error");
  EXPECT_THAT(preview.at("remarks").at(0).get<std::string>(), HasSubstr("2 files joined"));
  put(folder_ / "positions.csv", strange_positions(1));
  put(folder_ / "torques.csv", strange_torques(1));
  const SessionFiles files = intake_.files();
  const std::string both =
      (folder_ / "positions.csv").string() + "+" + (folder_ / "torques.csv").string();
  ASSERT_EQ(files.logs.size(), 1U);
  EXPECT_EQ(files.logs[0].name, both);
  EXPECT_EQ(files.kept_as, (folder_ / "positions.csv").string());
  EXPECT_EQ(files.commands_note, "");
  ChannelOptions options;
  options.file = files.channels->path;
  options.payloads = files.payloads;
  const RobotDescription robot = arm_description();
  for (const std::string& path : {files.logs[0].path, both}) {
    const Log log = read_log(path, robot, options);
    ASSERT_TRUE(log.payload);
    EXPECT_EQ(log.payload->mass_kg, 0.1);
    for (const ordered_json& signal : preview.at("signals")) {
      const auto joint = signal.at("joint").get<Eigen::Index>() - 1;
      const std::string quantity = signal.at("quantity");
      const Eigen::MatrixXd& all =
          quantity == "position" ? log.q : (quantity == "velocity" ? log.dq : log.tau);
      EXPECT_EQ(signal.at("high").get<double>(), all.col(joint).maxCoeff()) << quantity << joint;
    }
  }
  const ordered_json findings = intake_.findings(1, 200);
  EXPECT_THAT(findings.at("faults"), IsEmpty());
  EXPECT_LT(findings.at("joints").at(1).at("error_percent").get<double>(), 6);
  // One that lies elsewhere, and both do.
  put(folder_ / "torques.csv", "another");
  EXPECT_EQ(intake_.files().logs.at(0).name, "positions.csv+torques.csv");
  EXPECT_THAT(intake_.files().commands_note, HasSubstr("where they lie"));
}

TEST_F(Loading, KeepsFilesTogetherAndApartAsTheUserHasThem) {
  give("arm.toml", robot_text_of_arm());
  give("fast_pos.csv", strange_positions(1));
  give("slow_cur.csv", strange_torques(0.7));
  EXPECT_THAT(names_in(intake_.state()), ElementsAre("fast_pos.csv+slow_cur.csv"));
  // What comes later says better what belongs together.
  EXPECT_THAT(names_in(give("slow_pos.csv", strange_positions(0.7))),
              ElementsAre("fast_pos.csv", "slow_pos.csv+slow_cur.csv"));
  EXPECT_THAT(names_in(intake_.split(3)),
              ElementsAre("fast_pos.csv", "slow_cur.csv", "slow_pos.csv"));
  // Taken apart by hand they stay so, whatever comes.
  EXPECT_THAT(names_in(give("fast_cur.csv", strange_torques(1))),
              ElementsAre("fast_pos.csv+fast_cur.csv", "slow_cur.csv", "slow_pos.csv"));
  EXPECT_THAT(names_in(intake_.join(2, 3)),
              ElementsAre("fast_pos.csv+fast_cur.csv", "slow_pos.csv+slow_cur.csv"));
  const ordered_json state = give("arm.toml", robot_text_of_arm());
  EXPECT_THAT(names_in(state),
              ElementsAre("fast_pos.csv+fast_cur.csv", "slow_pos.csv+slow_cur.csv"));
  EXPECT_EQ(state.at("recordings").at(1).at("why_joined"), "");
  for (const auto& [id, to] : {std::pair{1, 1}, std::pair{1, 2}, std::pair{9, 1}}) {
    EXPECT_THROW(
        static_cast<void>(intake_.join(static_cast<std::size_t>(id), static_cast<std::size_t>(to))),
        Refused);
  }
  EXPECT_THROW(static_cast<void>(intake_.split(2)), Refused) << "a further file, no recording";
  EXPECT_EQ(intake_.state(), state);
  // A recording goes with all of its files.
  static_cast<void>(intake_.remove(1));
  EXPECT_THAT(names_in(intake_.remove(3)), IsEmpty());
  EXPECT_EQ(intake_.folder().used(), robot_text_of_arm().size());
}

TEST_F(Loading, KeepsWhatWasSaidOfColumnsWhereFilesAreJoinedAndTakenApart) {
  give("arm.toml", robot_text_of_arm());
  give("run.csv", strange_csv(1));
  static_cast<void>(intake_.set_signal({.quantity = "torque", .joint = 1, .scale = -1}));
  static_cast<void>(
      intake_.set_signal({.quantity = "velocity", .joint = 0, .source = std::string()}));
  give("again.csv", strange_csv(1));
  const auto said = [&](const ordered_json& state, const std::string& column) {
    const std::string text = state.at("map").at("text");
    EXPECT_THAT(text, HasSubstr("{source = \"" + column + "\", scale = -1.0"));
    EXPECT_THAT(text, HasSubstr("velocity = [\"\", "));
  };
  // Now every column has a namesake.
  said(intake_.join(2, 1), "1:drive_torque_2");
  said(intake_.split(1), "drive_torque_2");
  said(give("arm.toml", robot_text_of_arm()), "drive_torque_2");
  // And where they are not there for a while.
  static_cast<void>(intake_.remove(1));
  static_cast<void>(intake_.remove(2));
  const ordered_json other = give("positions.csv", strange_positions(1));
  EXPECT_THAT(other.at("map").at("notes").back().get<std::string>(),
              HasSubstr("the torque of joint 2 is left out"));
  static_cast<void>(intake_.remove(3));
  said(give("run.csv", strange_csv(1)), "drive_torque_2");
  EXPECT_THAT(intake_.guess_again().at("map").at("text").get<std::string>(),
              Not(HasSubstr("scale = -1.0")));
}

TEST_F(Loading, TakesTheOffsetOfAClockThatBeganElsewhere) {
  give("arm.toml", robot_text_of_arm());
  give("positions.csv", strange_positions(1));
  const ordered_json state = give("torques.csv", strange_torques(1, 5000));
  ASSERT_THAT(names_in(state), ElementsAre("positions.csv+torques.csv"));
  EXPECT_EQ(signal_at(state, 5).at("source"), "actual_pos_2") << "guessed all the same";
  EXPECT_EQ(signal_at(state, 4).at("source"), "drive_torque_1");
  const ordered_json apart = intake_.preview(1, 200);
  EXPECT_THAT(apart.at("error").get<std::string>(), HasSubstr("5000"));
  EXPECT_EQ(apart.at("signals").size(), 6U) << "the columns as they are";
  const ordered_json set = intake_.set_signal({.quantity = "time", .file = 1, .offset_s = -5000});
  EXPECT_EQ(signal_at(set, 1).at("offset_s"), -5000);
  EXPECT_EQ(signal_at(set, 1).at("more"), "");
  EXPECT_THAT(set.at("map").at("text").get<std::string>(),
              HasSubstr("time = [{source = \"time\"}, {source = \"time\", offset = -5000.0}]"));
  const ordered_json together = intake_.preview(1, 200);
  EXPECT_TRUE(together.at("error").is_null()) << together.at("error");
  EXPECT_THROW(
      static_cast<void>(intake_.set_signal({.quantity = "time", .file = 2, .offset_s = 1})),
      Refused);
}

TEST_F(Loading, AsksForTheTimeOfEveryFile) {
  give("arm.toml", robot_text_of_arm());
  give("positions.csv", strange_positions(1));
  std::string torques = strange_torques(1);
  torques.replace(0, 4, "what");
  give("torques.csv", torques);
  EXPECT_THAT(intake_.state().at("map").at("missing"), ElementsAre("the time of file 2"));
  const ordered_json state = intake_.set_signal({.quantity = "time", .source = "what", .file = 1});
  EXPECT_THAT(state.at("map").at("missing"), IsEmpty());
  EXPECT_TRUE(intake_.preview(1, 200).at("error").is_null());
}

// The robot file's own [channels], and names that a command line reads as two files.
TEST_F(Loading, ReadsSeveralFilesByTheRobotFilesChannels) {
  RobotDescription robot = arm_description();
  const std::filesystem::path channels = folder_ / "own.toml";
  put(channels,
      "[channels]\ntime = [\"time\", \"time\"]\nposition = [{source = \"actual_pos_1\", unit = "
      "\"deg\"}, {source = \"actual_pos_2\", unit = \"deg\"}]\ntorque = [\"2:drive_torque_1\", "
      "{source = \"drive_torque_2\", scale = -1}]\n");
  robot.channels = read_channels_file(channels, 2);
  give("arm.toml", robot_text(robot));
  give("a+b.csv", strange_torques(1));
  const ordered_json state = give("-q+.csv", strange_positions(1));
  EXPECT_THAT(names_in(state), ElementsAre("-q+.csv+a+b.csv"));
  EXPECT_TRUE(state.at("map").at("is_of_robot").get<bool>()) << state.at("map").at("notes");
  EXPECT_TRUE(intake_.preview(2, 200).at("error").is_null()) << intake_.preview(2, 200);
  const SessionFiles files = intake_.files();
  EXPECT_FALSE(files.channels);
  EXPECT_NO_THROW(static_cast<void>(read_log(files.logs.at(0).path, robot)));
}

TEST(SeveralFiles, BecomeASessionWhoseCommandsNameThemAll) {
  const TemporaryFolder folder;
  ServedStudio studio(std::make_unique<Intake>(IntakeSettings{.folder = folder.path()}),
                      open_files);
  const auto give = [&](const std::string& name, const std::string& content) {
    const auto [status, answer] =
        studio.post_text("load/files?name=" + name, content, "application/octet-stream");
    EXPECT_EQ(status, 200) << answer;
  };
  give("arm.toml", robot_text_of_arm());
  give("pos.csv", strange_positions(1));
  give("cur.csv", strange_torques(1));
  EXPECT_EQ(studio.post("load/join", {{"recording", 2}, {"to", 1}}).first, 400) << "joined";
  EXPECT_EQ(studio.post("load/join", {{"recording", 1}}).first, 400);
  EXPECT_EQ(studio.post("load/split", {{"recording", 1}}).first, 200);
  EXPECT_EQ(studio.post("load/split", {{"recording", 1}}).first, 409);
  EXPECT_EQ(studio.post("load/join", {{"recording", 2}, {"to", 1}}).first, 200);
  EXPECT_EQ(studio.post("load/signal", {{"quantity", "time"}, {"file", 3}, {"offset_s", 1}}).first,
            400);
  ASSERT_EQ(studio.post("load/signal", {{"quantity", "torque"}, {"joint", 2}, {"scale", -1}}).first,
            200);
  const json findings = studio.get("load/findings?recording=1&pixels=300").second;
  const auto [status, answer] = studio.post("load/session");
  ASSERT_EQ(status, 200) << answer;
  const json state = studio.get("state").second;
  EXPECT_EQ(state.at("recordings").at(0).at("name"), "pos.csv+cur.csv");
  EXPECT_EQ(state.at("joints").at(0).at("now").at("fitted_percent"),
            findings.at("joints").at(0).at("error_percent"));
  const auto [done, after] = studio.post("steps", {{"effect", "viscous_friction"}, {"joint", 2}});
  ASSERT_EQ(done, 200) << after;
  EXPECT_THAT(after.at("save").at("commands").at(0).get<std::string>(),
              HasSubstr("--log pos.csv+cur.csv"));
}

}  // namespace
