// Files that the page is given: where they lie, what their columns are, and the session that comes
// of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "common/refused.hpp"
#include "compare/compare.hpp"
#include "compare/measurement.hpp"
#include "desk/studio/loading.hpp"
#include "desk/studio/strange_files.hpp"
#include "desk/support/temporary_folder.hpp"
#include "log/read_log.hpp"
#include "look/look.hpp"
#include "look/look_report.hpp"
#include "robot/channels.hpp"
#include "robot/payload.hpp"
#include "robot/robot_file.hpp"
#include "studio/intake.hpp"
#include "studio/upload_folder.hpp"

namespace {

using nlohmann::ordered_json;
using offnominal::test::arm_description;
using offnominal::test::content_of;
using offnominal::test::Loading;
using offnominal::test::put;
using offnominal::test::robot_text_of_arm;
using offnominal::test::strange_csv;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

const ordered_json& signal_in(const ordered_json& state, const std::string& quantity, int joint) {
  for (const ordered_json& signal : state.at("map").at("signals")) {
    if (signal.at("quantity") == quantity && signal.at("joint") == joint) return signal;
  }
  throw std::runtime_error("no such signal");
}

TEST(UploadFolder, IsForNobodyElseAndGoesWithItsObject) {
  std::filesystem::path where;
  {
    UploadFolder folder;
    where = folder.path();
    struct stat of_folder {};
    ASSERT_EQ(::stat(where.c_str(), &of_folder), 0);
    EXPECT_EQ(of_folder.st_mode & 0777U, 0700U);
    const std::filesystem::path file = folder.put("a.csv", "1,2\n");
    EXPECT_EQ(file.filename(), "a.csv");
    EXPECT_EQ(content_of(file), "1,2\n");
    EXPECT_EQ(folder.used(), 4U);
    folder.remove(file);
    EXPECT_EQ(folder.used(), 0U);
    EXPECT_FALSE(std::filesystem::exists(file));
  }
  EXPECT_FALSE(std::filesystem::exists(where));
}

TEST(UploadFolder, TakesNamesAndNoPaths) {
  UploadFolder folder;
  for (const char* name :
       {"", ".", "..", "/etc/passwd", "../a.csv", "a/b.csv", "a\\b.csv", "a\nb"}) {
    EXPECT_THROW(static_cast<void>(folder.begin(name)), Refused) << name;
  }
  EXPECT_THROW(static_cast<void>(folder.begin(std::string(201, 'a'))), Refused);
  // A name that a command line would read as two files, and one that a page might take for markup.
  for (const char* name : {"a+b.csv", "-o", "<img src=x>.csv"}) {
    EXPECT_EQ(folder.put(name, "x").filename(), name);
  }
}

TEST(UploadFolder, SaysItsLimitsAndKeepsNothingOfWhatIsBeyondThem) {
  UploadFolder folder({.file = 10, .all = 15});
  const std::filesystem::path kept = folder.put("kept.csv", "0123456789");
  for (const auto& [content, limit] :
       {std::pair{"01234567890", "10 bytes a file"}, std::pair{"012345", "15 bytes on the page"}}) {
    try {
      static_cast<void>(folder.put("more.csv", content));
      ADD_FAILURE() << content;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(limit));
      EXPECT_THAT(error.what(), HasSubstr("more.csv"));
      EXPECT_THAT(error.what(), Not(HasSubstr(folder.path().string())));
    }
    EXPECT_EQ(folder.used(), 10U);
  }
  EXPECT_TRUE(std::filesystem::exists(kept));
}

// The [channels] that the page would write.
ChannelMap read_channels_of(const ordered_json& state) {
  const TemporaryFolder folder;
  put(folder / "channels.toml", state.at("map").at("text").get<std::string>());
  return read_channels_file(folder / "channels.toml", 2);
}

TEST_F(Loading, GuessesTheColumnsAsLookDoesWhicheverFileComesFirst) {
  EXPECT_TRUE(give("run.csv", strange_csv(1)).at("map").is_null());
  const ordered_json state = give("arm.toml", robot_text_of_arm());
  EXPECT_EQ(signal_in(state, "position", 2).at("source"), "actual_pos_2");
  EXPECT_EQ(signal_in(state, "position", 2).at("unit"), "deg");
  EXPECT_EQ(signal_in(state, "velocity", 1).at("unit"), "rad/s");
  const std::filesystem::path file = folder_ / "same.csv";
  put(file, strange_csv(1));
  const RobotDescription robot = arm_description();
  EXPECT_EQ(state.at("map").at("text").get<std::string>(),
            channels_text(look_at(file, &robot, std::nullopt)));
}

TEST_F(Loading, ReadsTheCurvesAsTheWrittenChannelsDo) {
  give("arm.toml", robot_text_of_arm());
  give("run.csv", strange_csv(1));
  static_cast<void>(intake_.set_signal({.quantity = "torque", .joint = 1, .scale = -1}));
  const ordered_json preview = intake_.preview(1, 200);
  ASSERT_TRUE(preview.at("error").is_null()) << preview.at("error");
  const std::filesystem::path recording = folder_ / "run.csv";
  put(recording, strange_csv(1));
  const SessionFiles files = intake_.files();
  ASSERT_TRUE(files.channels);
  static_cast<void>(intake_.write(files));
  EXPECT_EQ(files.channels->name, (folder_ / "arm_channels.toml").string());
  const Log log = read_log(recording, 2, read_channels_file(files.channels->name, 2));
  for (const ordered_json& signal : preview.at("signals")) {
    const auto joint = signal.at("joint").get<Eigen::Index>() - 1;
    const std::string quantity = signal.at("quantity");
    const Eigen::MatrixXd& all =
        quantity == "position" ? log.q : (quantity == "velocity" ? log.dq : log.tau);
    EXPECT_EQ(signal.at("high").get<double>(), all.col(joint).maxCoeff()) << quantity << joint;
    EXPECT_EQ(signal.at("low").get<double>(), all.col(joint).minCoeff()) << quantity << joint;
  }
}

TEST_F(Loading, HasTheDoctorAndTheErrorOfCompareBesideTheCurves) {
  give("arm.toml", robot_text_of_arm());
  give("run.csv", strange_csv(1));
  ordered_json findings = intake_.findings(1, 200);
  ASSERT_EQ(findings.at("faults").size(), 1U) << findings.at("faults");
  EXPECT_EQ(findings.at("faults").at(0).at("fault"), "torque_sign");
  EXPECT_EQ(findings.at("faults").at(0).at("joint"), 2);
  EXPECT_TRUE(findings.at("faults").at(0).at("spoils").get<bool>());
  static_cast<void>(intake_.set_signal({.quantity = "torque", .joint = 1, .scale = -1}));
  findings = intake_.findings(1, 200);
  EXPECT_THAT(findings.at("faults"), IsEmpty());
  EXPECT_LT(findings.at("joints").at(1).at("error_percent").get<double>(), 5);
  // Degrees that are taken for radians.
  static_cast<void>(intake_.set_signal({.quantity = "position", .joint = 0, .unit = "rad"}));
  EXPECT_EQ(intake_.findings(1, 200).at("faults").at(0).at("joint"), 1);
}

TEST_F(Loading, TakesTheUnitThatTheNameOfAColumnSays) {
  give("arm.toml", robot_text_of_arm());
  std::string text = strange_csv(1);
  text.replace(text.find("actual_pos_1"), 12, "actual_pos_1 [deg]");
  text.replace(text.find("actual_pos_2"), 12, "actual_pos_2 [deg]");
  const ordered_json state = give("run.csv", text);
  const double before = intake_.preview(1, 200).at("signals").at(0).at("high");
  for (const int joint : {2, 1}) {
    const std::string source = signal_in(state, "position", joint).at("source");
    static_cast<void>(intake_.set_signal({.quantity = "position", .source = source}));
  }
  EXPECT_EQ(intake_.preview(1, 200).at("signals").at(0).at("high").get<double>(), before);
  static_cast<void>(intake_.set_signal({.quantity = "position", .joint = 0, .scale = -1}));
  EXPECT_EQ(intake_.preview(1, 200).at("signals").at(0).at("low").get<double>(), -before);
}

// What the file itself says of a unit does not count beside a scale: it has to be written.
TEST(SignalMap, WritesTheUnitOfTheFileWhereASignIsTurned) {
  NamedColumns columns;
  columns.columns["a"] = Eigen::VectorXd::Ones(3);
  columns.units["a"] = "deg";
  const RobotDescription robot = arm_description();
  const MappedColumns of(columns);
  ChannelMap map = with_all_joints({}, 2);
  studio::set_signal(map, {.quantity = "position", .joint = 1, .source = "a"}, robot, of);
  EXPECT_EQ(map.position[1].unit, "");
  EXPECT_EQ(signals_json(map, robot, of).at(4).at("unit"), "deg");
  studio::set_signal(map, {.quantity = "position", .joint = 1, .scale = -1}, robot, of);
  EXPECT_EQ(map.position[1].unit, "deg");
  EXPECT_EQ(missing_of(map).size(), 4U);
}

TEST_F(Loading, RefusesEditsOfWhatThereIsNotAndChangesNothing) {
  give("arm.toml", robot_text_of_arm());
  give("run.csv", strange_csv(1));
  const ordered_json before = intake_.state();
  for (const SignalEdit& edit : {SignalEdit{.quantity = "position", .joint = 2},
                                 SignalEdit{.quantity = "position", .source = "no_such"},
                                 SignalEdit{.quantity = "position", .unit = "Nm"},
                                 SignalEdit{.quantity = "position", .scale = 0},
                                 SignalEdit{.quantity = "position", .of = "current"}}) {
    EXPECT_THROW(static_cast<void>(intake_.set_signal(edit)), Refused) << edit.quantity;
  }
  EXPECT_EQ(intake_.state(), before);
  // What is no mistake of the page, but of the file that would be written, stands beside the
  // curves.
  static_cast<void>(intake_.set_signal({.quantity = "torque", .of = "current"}));
  EXPECT_THAT(intake_.preview(1, 200).at("error").get<std::string>(), HasSubstr("transmission"));
  EXPECT_FALSE(intake_.preview(1, 200).at("signals").empty());
}

double error_of(const ordered_json& findings, std::size_t joint) {
  return findings.at("joints").at(joint).at("error_percent").get<double>();
}

TEST_F(Loading, HasWhatARecordingCarriedInTheModelsTorqueUntilItIsTakenAway) {
  give("arm.toml", robot_text_of_arm());
  give("run.csv", strange_csv(1));
  give("more.csv", strange_csv(0.7));
  static_cast<void>(intake_.set_signal({.quantity = "torque", .joint = 1, .scale = -1}));
  const ordered_json bare = intake_.findings(1, 200);
  const ordered_json state = intake_.set_payload(1, Payload{0.5, {0.1, 0, 0.02}});
  EXPECT_EQ(state.at("recordings").at(0).at("payload").at("words"),
            "0.5 kg at [0.1, 0, 0.02] m of the last link");
  EXPECT_TRUE(state.at("recordings").at(1).at("payload").is_null());
  const ordered_json loaded = intake_.findings(1, 200);
  EXPECT_NE(error_of(loaded, 1), error_of(bare, 1));
  EXPECT_NE(loaded.at("joints").at(1).at("model"), bare.at("joints").at(1).at("model"));
  // As compare says it of the same recording with --payload.
  const std::filesystem::path recording = folder_ / "run.csv";
  put(recording, strange_csv(1));
  const SessionFiles files = intake_.files();
  ASSERT_EQ(files.payloads.size(), 1U);
  EXPECT_EQ(text_of(files.payloads.at(0)), "run.csv=0.5@0.1,0,0.02");
  const RobotDescription robot = arm_description();
  ChannelOptions options;
  options.file = files.channels->path;
  options.payloads = files.payloads;
  const Comparison compared = compare(robot, measure(read_log(recording, robot, options), robot));
  EXPECT_EQ(error_of(loaded, 1), compared.joints.at(1).relative_error_percent);
  EXPECT_EQ(intake_.set_payload(1, std::nullopt).at("recordings").at(0).at("payload"), nullptr);
  EXPECT_EQ(intake_.findings(1, 200).at("joints"), bare.at("joints"));
  EXPECT_THAT(intake_.files().payloads, IsEmpty());
}

TEST_F(Loading, RefusesAPayloadAsTheCommandLineDoesAndKeepsTheOneThatIsThere) {
  give("arm.toml", robot_text_of_arm());
  give("run.csv", strange_csv(1));
  static_cast<void>(intake_.set_payload(1, Payload{0.5, {0, 0, 0}}));
  const ordered_json before = intake_.state();
  for (const Payload& payload :
       {Payload{-1, {0, 0, 0}}, Payload{1e6, {0, 0, 0}}, Payload{1, {0, -101, 0}}}) {
    try {
      static_cast<void>(intake_.set_payload(1, payload));
      ADD_FAILURE() << words_of(payload);
    } catch (const InputError& error) {
      EXPECT_EQ(error.problem().place, "payload");
      EXPECT_EQ(error.problem().allowed, "a mass of 0 kg or more and a place in m");
      EXPECT_THAT(error.problem().mend, StartsWith("write a mass of 0 to "));
    }
  }
  EXPECT_THROW(static_cast<void>(intake_.set_payload(9, std::nullopt)), Refused);
  EXPECT_EQ(intake_.state(), before);
}

TEST_F(Loading, PutsWhatThePageSaysBeforeWhatTheRobotFileSaysOfAPayload) {
  RobotDescription robot = arm_description();
  give("run.csv", strange_csv(1));
  ChannelMap channels = read_channels_of(give("arm.toml", robot_text_of_arm()));
  channels.payloads = {{"run.csv", {0.5, {0.1, 0, 0}}}};
  robot.channels = channels;
  give("arm.toml", robot_text(robot));
  const double of_file = error_of(intake_.findings(1, 200), 0);
  static_cast<void>(intake_.set_payload(1, Payload{0, {0, 0, 0}}));
  const double of_page = error_of(intake_.findings(1, 200), 0);
  EXPECT_LT(of_page, of_file);
  static_cast<void>(intake_.set_payload(1, std::nullopt));
  EXPECT_EQ(error_of(intake_.findings(1, 200), 0), of_file);
}

// No session, but what explain and add --all-found read.
TEST_F(Loading, WritesWhatIsSaidOfHoldMapsAndTheCommandsThatSearchThem) {
  give("arm.toml", robot_text_of_arm());
  std::string text = strange_csv(1);
  text.replace(0, 4, "what");
  give("map.csv", text);
  give("other.csv", strange_csv(0.5));
  EXPECT_THAT(intake_.state().at("map").at("missing"), ElementsAre("the time"));
  EXPECT_THROW(static_cast<void>(intake_.write_at_rest()), Refused) << "a recording in time";
  const ordered_json state = intake_.set_at_rest(true);
  EXPECT_TRUE(state.at("map").at("at_rest").get<bool>());
  EXPECT_THAT(state.at("map").at("missing"), IsEmpty());
  EXPECT_THAT(state.at("map").at("text").get<std::string>(),
              StartsWith("[channels]\nat_rest = true\nposition = "));
  EXPECT_THAT(state.at("map").at("text").get<std::string>(), Not(HasSubstr("velocity")));
  const ordered_json preview = intake_.preview(1, 200);
  ASSERT_TRUE(preview.at("error").is_null()) << preview.at("error");
  EXPECT_EQ(preview.at("sampling"), "3001 readings at rest");
  ASSERT_EQ(preview.at("signals").size(), 4U) << "no velocities";
  EXPECT_THAT(intake_.findings(1, 200).at("faults"), IsEmpty());
  EXPECT_THROW(static_cast<void>(intake_.files()), Refused) << "no session is over it";
  static_cast<void>(intake_.set_held_out(2, true));
  static_cast<void>(intake_.set_payload(1, Payload{0.5, {0, 0, 0}}));
  const ordered_json written = intake_.write_at_rest();
  const std::string channels = (folder_ / "arm_channels.toml").string();
  const std::string robot = (folder_ / "arm.toml").string();
  EXPECT_THAT(written.at("written"), ElementsAre(robot, channels));
  const std::string more =
      " --holdout other.csv --channels " + channels + " --payload map.csv=0.5@0,0,0";
  EXPECT_THAT(written.at("commands"),
              ElementsAre("offnominal explain map.csv --robot " + robot + more,
                          "offnominal add --all-found --robot " + robot + " --log map.csv" + more +
                              " -o " + (folder_ / "arm_found.toml").string()));
  EXPECT_THAT(written.at("note").get<std::string>(), HasSubstr("where they lie"));
  put(folder_ / "map.csv", text);
  ChannelOptions options;
  options.file = channels;
  const Log log = read_log_or_hold_map(folder_ / "map.csv", arm_description(), options);
  EXPECT_TRUE(log.at_rest);
  EXPECT_EQ(preview.at("signals").at(0).at("high").get<double>(), log.q.col(0).maxCoeff());
  // What was said of it stays said where the robot file is dropped anew, and what is not read
  // there.
  EXPECT_TRUE(give("arm.toml", robot_text_of_arm()).at("map").at("at_rest").get<bool>());
  EXPECT_THAT(intake_.set_at_rest(false).at("map").at("missing"), ElementsAre("the time"));
  EXPECT_EQ(signal_in(intake_.state(), "velocity", 1).at("source"), "actual_vel_1");
}

TEST_F(Loading, TakesHoldMapsOfTheRobotFilesOwnWordAndSaysWhyOneCannotBeRead) {
  RobotDescription robot = arm_description();
  ChannelMap channels =
      read_channels_of((give("run.csv", strange_csv(1)), give("arm.toml", robot_text(robot))));
  channels.at_rest = true;
  robot.channels = as_written(channels);
  ordered_json state = give("arm.toml", robot_text(robot));
  EXPECT_TRUE(state.at("map").at("at_rest").get<bool>());
  EXPECT_TRUE(state.at("map").at("is_of_robot").get<bool>());
  EXPECT_THAT(intake_.write_at_rest().at("written").size(), 1U) << "the robot file alone";
  // Too few readings, and several files, as of the command line.
  static_cast<void>(intake_.remove(1));
  give("few.csv", strange_csv(1).substr(0, 2000));
  EXPECT_THAT(intake_.preview(2, 200).at("error").get<std::string>(), HasSubstr("200 readings"));
  EXPECT_THROW(static_cast<void>(intake_.write_at_rest()), InputError);
  give("run.csv", strange_csv(1));
  static_cast<void>(intake_.join(3, 2));
  EXPECT_THAT(intake_.preview(2, 200).at("error").get<std::string>(), HasSubstr("2 files"));
  EXPECT_FALSE(intake_.preview(2, 200).at("signals").empty());
}

TEST_F(Loading, SaysWhatIsMissingBeforeASessionCanBegin) {
  const auto refusal = [&] {
    try {
      static_cast<void>(intake_.files());
    } catch (const Refused& refused) {
      return std::string(refused.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal(), HasSubstr("robot file"));
  give("arm.toml", robot_text_of_arm());
  EXPECT_THAT(refusal(), HasSubstr("recording"));
  std::string text = strange_csv(1);
  text.replace(text.find("drive_torque_2"), 14, "something_else");
  give("run.csv", text);
  EXPECT_THAT(refusal(), HasSubstr("torque of joint 2"));
  EXPECT_THAT(intake_.preview(1, 200).at("error").get<std::string>(),
              HasSubstr("torque of joint 2"));
  for (std::size_t joint = 0; joint < 2; ++joint) {
    static_cast<void>(
        intake_.set_signal({.quantity = "torque",
                            .joint = joint,
                            .source = joint == 0 ? "drive_torque_1" : "something_else"}));
  }
  EXPECT_EQ(refusal(), "");
  static_cast<void>(intake_.set_held_out(1, true));
  EXPECT_THAT(refusal(), HasSubstr("held out"));
}

TEST_F(Loading, RefusesWhatCannotBeReadByItsNameAndKeepsTheRest) {
  give("arm.toml", robot_text_of_arm());
  give("run.csv", strange_csv(1));
  for (const auto& [name, content] :
       {std::pair{"broken.toml", std::string("name = 3\n")}, std::pair{"empty.csv", std::string()},
        std::pair{"run.csv", strange_csv(0.5)}}) {
    const std::string words = refusal_of(name, content);
    EXPECT_THAT(words, StartsWith(name));
    EXPECT_THAT(words, Not(HasSubstr(intake_.folder().path().string())));
  }
  EXPECT_EQ(intake_.state().at("recordings").size(), 1U);
  EXPECT_EQ(intake_.state().at("robot").at("file"), "arm.toml");
  // A file on this machine that the page names inside of one that it hands over.
  const std::string names_another = robot_text_of_arm() +
                                    "\n[channels]\nposition = [\"a\", \"b\"]\ntorque = [\"c\", "
                                    "\"d\"]\ndbc = \"/etc/passwd\"\n";
  EXPECT_THAT(refusal_of("dbc.toml", names_another), HasSubstr("channels.dbc"));
}

TEST_F(Loading, NamesFilesThatAreThereAlreadyAndWritesOverNone) {
  put(folder_ / "arm.toml", robot_text_of_arm());
  put(folder_ / "run.csv", strange_csv(1));
  put(folder_ / "arm_channels.toml", "somebody's");
  give("arm.toml", robot_text_of_arm());
  give("run.csv", strange_csv(1));
  const SessionFiles files = intake_.files();
  EXPECT_EQ(files.robot.name, (folder_ / "arm.toml").string());
  EXPECT_EQ(files.logs.at(0).name, (folder_ / "run.csv").string());
  EXPECT_EQ(files.commands_note, "");
  EXPECT_THAT(intake_.write(files), ElementsAre((folder_ / "arm_channels_2.toml").string()));
  EXPECT_EQ(content_of(folder_ / "arm_channels.toml"), "somebody's");
  // The same names with another content are other files.
  put(folder_ / "run.csv", strange_csv(0.5));
  put(folder_ / "arm.toml", robot_text_of_arm() + "# another\n");
  EXPECT_EQ(intake_.files().logs.at(0).name, "run.csv");
  EXPECT_THAT(intake_.files().commands_note, HasSubstr("where they lie"));
  EXPECT_EQ(intake_.files().robot.name, (folder_ / "arm_2.toml").string());
}

}  // namespace
