#include "sil/real_time.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/number.hpp"
#include "loop/refusal_words.hpp"
#include "sil/child_program.hpp"
#include "sil/gather.hpp"
#include "sil/mujoco_plant_of.hpp"
#include "sil/plant_of.hpp"
#include "sil/scenario_file.hpp"

namespace offnominal::desk::sil {
namespace {

namespace fs = std::filesystem;

// Removed with what is in it.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "offnominal-sil-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw InputError({name, "", std::strerror(errno), "a folder for the run's recordings",
                        "set TMPDIR to one that can be written"});
    }
    path_ = name;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  Folder(Folder&&) = delete;
  Folder& operator=(Folder&&) = delete;
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] fs::path operator/(const char* name) const { return path_ / name; }

 private:
  fs::path path_;
};

std::vector<std::string> plant_arguments(const Folder& folder, const RealTimeOptions& options,
                                         const std::optional<std::string>& mujoco, double rate_hz) {
  std::vector<std::string> arguments = {
      "--bus",    options.interface, "--scenario", (folder / "scenario.toml").string(),
      "--rate",   shortest(rate_hz), "--log",      (folder / "plant.csv").string(),
      "--motion", options.motion,    "--json"};
  if (options.plant_file) arguments.insert(arguments.end(), {"--robot", *options.plant_file});
  if (options.robot_file) arguments.insert(arguments.end(), {"--drives", *options.robot_file});
  if (mujoco) arguments.insert(arguments.end(), {"--plant", kMujocoPrefix + *mujoco});
  return arguments;
}

std::vector<std::string> controller_arguments(const Folder& folder, const Scenario& scenario,
                                              const RealTimeOptions& options, double rate_hz,
                                              hal::FrameFormat format) {
  std::vector<std::string> arguments = {"--bus",        options.interface,
                                        "--rate",       shortest(rate_hz),
                                        "--motion",     options.motion,
                                        "--arm",        "--end-at-fault",
                                        "--duration",   shortest(scenario.duration_s),
                                        "--log",        (folder / "controller.csv").string(),
                                        "--no-restart", "--json"};
  const auto add = [&](std::initializer_list<std::string> words) {
    arguments.insert(arguments.end(), words);
  };
  if (options.robot_file) add({"--robot", *options.robot_file});
  if (options.candump) add({"--candump", *options.candump});
  if (options.replace_candump) add({"--force"});
  if (scenario.accommodate) add({"--accommodate"});
  const std::vector<std::string> at_detection = act_arguments(scenario);
  arguments.insert(arguments.end(), at_detection.begin(), at_detection.end());
  add({format == hal::FrameFormat::kFd ? "--fd" : "--classic"});
  if (!scenario.sends_velocity) {
    add({"--observe-velocity", shortest(scenario.max_acceleration)});
    if (scenario.encoder_bits_per_turn > 0) {
      add({"--encoder-bits", std::to_string(scenario.encoder_bits_per_turn)});
    }
  }
  return arguments;
}

[[noreturn]] void ended_early(const std::string& program, const std::string& found,
                              const fs::path& words) {
  throw InputError({program, "", found, "a run to its end", read_text_file(words)});
}

// Until the controller has ended by itself: at the motion's end, or after a fault.
void wait_for_end(ChildProgram& controller, ChildProgram& plant, const Folder& folder,
                  double duration_s) {
  using Clock = std::chrono::steady_clock;
  constexpr double kPatience = 20;
  const auto end = Clock::now() + std::chrono::duration<double>(duration_s + kPatience);
  while (!controller.exit_code()) {
    if (const auto code = plant.exit_code()) {
      ended_early("offnominal-plant", fmt::format("exit code {}", *code), folder / "plant.err");
    }
    if (Clock::now() > end) {
      controller.wait(true, 1);
      ended_early("offnominal-controller", "no valid frames of every joint",
                  folder / "controller.err");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds{10});
  }
  constexpr int kBadInput = 2;
  if (*controller.exit_code() >= kBadInput) {
    ended_early("offnominal-controller", fmt::format("exit code {}", *controller.exit_code()),
                folder / "controller.err");
  }
}

}  // namespace

SilResult run_in_real_time(const RobotDescription& robot, const Scenario& scenario,
                           const RealTimeOptions& options) {
  check_scenario(robot, scenario);
  check_real_time(scenario);
  if (scenario.precision != Precision::kFloat) {
    throw InputError({"sil", "precision", "double", "float, in real time", ""});
  }
  const Folder folder;
  const double rate_hz = 1 / robot.estimator.period_s;
  Scenario complete = scenario;
  complete.format = format_of(scenario, robot.drive_settings(), robot.estimator.period_s);
  write_file_atomically(folder / "scenario.toml", scenario_text(complete));
  ChildProgram plant("offnominal-plant", plant_arguments(folder, options, scenario.mujoco, rate_hz),
                     folder / "plant.json", folder / "plant.err");
  ChildProgram controller(
      "offnominal-controller",
      controller_arguments(folder, scenario, options, rate_hz, *complete.format),
      folder / "controller.json", folder / "controller.err");
  wait_for_end(controller, plant, folder, scenario.duration_s);
  constexpr double kPatience = 10;
  if (const int code = plant.wait(true, kPatience); code != 0) {
    ended_early("offnominal-plant", fmt::format("exit code {}", code), folder / "plant.err");
  }
  const auto json = [&](const char* name) {
    return nlohmann::json::parse(read_text_file(folder / name));
  };
  const Recordings recordings{folder / "controller.csv", json("controller.json"),
                              folder / "plant.csv", json("plant.json")};
  if (recordings.plant.at("arm_time_s").get<double>() > 0) {
    return gather(robot, scenario, options.interface, recordings);
  }
  const auto refusal =
      static_cast<controller::Fault>(recordings.controller.at("refusal_number").get<int>());
  if (refusal != controller::Fault::kNone) {
    throw InputError({"offnominal-controller", "",
                      std::string("arming refused: ") + controller::name_of(refusal),
                      "an arm where its motion starts, a robot file with gains and torque limits",
                      mend_of(refusal, robot)});
  }
  throw InputError(
      {"offnominal-controller", "",
       "fault " + recordings.controller.at("fault").get<std::string>() + " before the arm moved",
       "ticks that begin in time",
       "this machine is too slow or too busy for them: fewer ticks, by period_s of "
       "the robot file"});
}

}  // namespace offnominal::desk::sil
