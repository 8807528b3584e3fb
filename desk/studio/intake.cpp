#include "studio/intake.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/nearest.hpp"
#include "common/refused.hpp"
#include "common/shell_word.hpp"
#include "look/look.hpp"
#include "look/looked_files.hpp"
#include "robot/channel_text.hpp"
#include "robot/payload.hpp"
#include "robot/payload_check.hpp"
#include "robot/robot_file.hpp"
#include "studio/preview.hpp"

namespace offnominal::desk::studio {
namespace {

using nlohmann::ordered_json;

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return extension;
}

bool same_content(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(b, failure)) return false;
  const auto size = std::filesystem::file_size(a, failure);
  if (failure || size != std::filesystem::file_size(b, failure) || failure) return false;
  std::ifstream first(a, std::ios::binary);
  std::ifstream second(b, std::ios::binary);
  constexpr std::streamsize kAtOnce = 1 << 16;
  std::string x(kAtOnce, '\0');
  std::string y(kAtOnce, '\0');
  while (first.read(x.data(), kAtOnce), first.gcount() > 0) {
    const std::streamsize got = first.gcount();
    second.read(y.data(), kAtOnce);
    if (second.gcount() != got || !std::equal(x.begin(), x.begin() + got, y.begin())) return false;
  }
  return true;
}

ordered_json payload_json(const std::optional<Payload>& payload) {
  if (!payload) return nullptr;
  return {{"mass_kg", payload->mass_kg},
          {"x_m", payload->place_m[0]},
          {"y_m", payload->place_m[1]},
          {"z_m", payload->place_m[2]},
          {"words", words_of(*payload)}};
}

}  // namespace

Intake::Intake(IntakeSettings settings)
    : settings_(std::move(settings)), folder_(settings_.limits) {
  if (!settings_.robot_file) return;
  use_robot(
      {read_robot_file(*settings_.robot_file), {*settings_.robot_file, *settings_.robot_file}});
}

ordered_json Intake::state() {
  const std::lock_guard guard(lock_);
  return state_now();
}

ordered_json Intake::take(const std::filesystem::path& file) {
  const std::lock_guard guard(lock_);
  const std::string kind = lower_extension(file);
  try {
    if (kind == ".toml") {
      use_robot(robot_of_toml(file));
      forget_urdf();
    } else if (kind == ".urdf") {
      take_urdf(file);
    } else {
      take_recording(file);
    }
  } catch (const InputError& error) {
    folder_.remove(file);
    throw folder_.shown(error);
  } catch (...) {
    folder_.remove(file);
    throw;
  }
  ++revision_;
  return state_now();
}

void Intake::take_urdf(const std::filesystem::path& file) {
  GivenUrdf urdf(file);
  if (!urdf.has_choice()) {
    use_robot(urdf.robot(folder_));
    folder_.remove(file);
    forget_urdf();
    return;
  }
  forget_urdf();
  urdf_ = std::move(urdf);
}

void Intake::forget_urdf() {
  if (urdf_) folder_.remove(urdf_->file());
  urdf_.reset();
}

ordered_json Intake::choose_chain(std::size_t chain) {
  const std::lock_guard guard(lock_);
  if (!urdf_) throw Refused(Refused::Why::kNotNow, "There is no URDF with several chains.");
  use_robot(urdf_->robot(chain, folder_));
  urdf_->choose(chain);
  ++revision_;
  return state_now();
}

void Intake::use_robot(GivenRobot robot) {
  std::optional<GivenRobot> before = std::exchange(robot_, std::move(robot));
  std::optional<ChannelMap> map_before = std::exchange(map_, std::nullopt);
  try {
    // How a log of a bus is decoded may follow from the robot file.
    for (Recording& recording : recordings_) recording.columns = read_columns(recording.path);
    guess();
  } catch (...) {
    map_ = std::move(map_before);
    folder_.remove(robot_->file.path);
    robot_ = std::move(before);
    throw;
  }
  if (before && before->file.path != robot_->file.path) folder_.remove(before->file.path);
}

NamedColumns Intake::read_columns(const std::filesystem::path& file) const {
  NamedColumns columns =
      read_looked_files(file, robot_ ? &robot_->description : nullptr, std::nullopt).columns;
  columns.file = file.filename().string();
  return columns;
}

void Intake::take_recording(const std::filesystem::path& file) {
  Recording recording;
  recording.name = file.filename().string();
  for (const Recording& other : recordings_) {
    if (other.name != recording.name) continue;
    throw InputError({recording.name, "", "a recording of that name that is there already",
                      "names that differ", "take the other one away, or give this one another"});
  }
  recording.path = file;
  recording.columns = read_columns(file);
  recording.id = next_id_++;
  recordings_.push_back(std::move(recording));
  try {
    guess();
  } catch (...) {
    recordings_.pop_back();
    throw;
  }
}

void Intake::guess() {
  if (map_ || !robot_ || recordings_.empty()) return;
  RobotDescription robot = robot_->description;
  // Of readings at rest, which no session is over.
  if (robot.channels && robot.channels->at_rest) robot.channels.reset();
  Look look;
  try {
    look = look_at(recordings_.front().path, &robot, std::nullopt);
  } catch (const InputError& error) {
    throw folder_.shown(error);
  }
  map_is_of_robot_ = !look.by_robot.empty();
  map_source_ = map_is_of_robot_ ? "the robot file's own [channels]"
                : look.guessed   ? "the numbers: the file has no names that say anything"
                                 : "the columns' names";
  if (!look.t_s && look.channels.period_s == 0) look.channels.time = {};
  if (!map_is_of_robot_) look.channels.extra.clear();
  map_ = with_all_joints(std::move(look.channels), robot_->description.joints.size());
  notes_.clear();
  for (const std::string& note : look.notes) notes_.push_back(folder_.shown(note));
  others_ = std::move(look.unread);
}

Intake::Recording& Intake::recording_of(std::size_t id) {
  for (Recording& recording : recordings_) {
    if (recording.id == id) return recording;
  }
  throw Refused(Refused::Why::kBadRequest, "There is no such recording.");
}

ordered_json Intake::remove(std::size_t id) {
  const std::lock_guard guard(lock_);
  const Recording& recording = recording_of(id);
  folder_.remove(recording.path);
  recordings_.remove_if([&](const Recording& one) { return one.id == id; });
  if (recordings_.empty()) map_.reset();
  ++revision_;
  return state_now();
}

ordered_json Intake::set_held_out(std::size_t id, bool held_out) {
  const std::lock_guard guard(lock_);
  recording_of(id).held_out = held_out;
  ++revision_;
  return state_now();
}

ordered_json Intake::set_payload(std::size_t id, const std::optional<Payload>& payload) {
  const std::lock_guard guard(lock_);
  Recording& recording = recording_of(id);
  if (payload) check_payload({recording.name, *payload});
  recording.payload = payload;
  ++revision_;
  return state_now();
}

ordered_json Intake::set_signal(const SignalEdit& edit) {
  const std::lock_guard guard(lock_);
  if (!map_) throw Refused(Refused::Why::kNotNow, "There is no recording and robot file yet.");
  studio::set_signal(*map_, edit, robot_->description, all_columns());
  map_is_of_robot_ = false;
  ++revision_;
  return state_now();
}

ordered_json Intake::guess_again() {
  const std::lock_guard guard(lock_);
  const std::optional<ChannelMap> before = std::exchange(map_, std::nullopt);
  try {
    guess();
  } catch (...) {
    map_ = before;
    throw;
  }
  ++revision_;
  return state_now();
}

ChannelMap Intake::map_of(const Recording& recording) const {
  if (!map_) throw Refused(Refused::Why::kNotNow, "There is no robot file yet.");
  ChannelMap map = *map_;
  if (recording.payload) map.payloads = {{recording.name, *recording.payload}};
  return map;
}

ordered_json Intake::preview(std::size_t id, std::size_t pixels) {
  const std::lock_guard guard(lock_);
  const Recording& recording = recording_of(id);
  const ChannelMap map = map_of(recording);
  ordered_json json{{"revision", revision_}, {"recording", id}};
  json.update(preview_of(recording.columns, robot_->description, map, pixels));
  return json;
}

ordered_json Intake::findings(std::size_t id, std::size_t pixels) {
  const std::lock_guard guard(lock_);
  const Recording& recording = recording_of(id);
  const ChannelMap map = map_of(recording);
  ordered_json json{{"revision", revision_}, {"recording", id}};
  json.update(findings_of(recording.columns, robot_->description, map, settings_.keep, pixels));
  return json;
}

std::filesystem::path Intake::here(const std::string& name) const {
  return settings_.folder / std::filesystem::path(name);
}

// "arm_channels.toml", or "arm_channels_2.toml" where that is there, and so on.
std::string Intake::free_name(const std::string& stem, const std::string& ending) const {
  for (int number = 1;; ++number) {
    const std::string again = number == 1 ? "" : fmt::format("_{}", number);
    const std::filesystem::path path = here(fmt::format("{}{}{}", stem, again, ending));
    std::error_code ignored;
    if (!std::filesystem::exists(std::filesystem::symlink_status(path, ignored))) {
      return path.string();
    }
  }
}

// One of the page under the name that it has or would be written by.
NamedFile Intake::robot_to_use() const {
  NamedFile file = robot_->file;
  if (settings_.robot_file && file.path == *settings_.robot_file) return file;
  file.name = here(file.name).string();
  if (!same_content(file.path, file.name)) {
    file.name = free_name(std::filesystem::path(file.name).stem().string(), ".toml");
  }
  return file;
}

SessionFiles Intake::files() {
  const std::lock_guard guard(lock_);
  const auto not_now = [](const std::string& words) {
    throw Refused(Refused::Why::kNotNow, words);
  };
  if (!robot_) not_now("A robot file is missing: drop a .toml or a .urdf.");
  SessionFiles files;
  for (const Recording& recording : recordings_) {
    const std::filesystem::path own = here(recording.name);
    const bool is_here = same_content(recording.path, own);
    if (!is_here) {
      files.commands_note =
          "The recordings were dropped on the page: run these where they lie, or write their "
          "folders before their names.";
    }
    auto& group = recording.held_out ? files.holdout : files.logs;
    group.push_back({recording.path.string(), is_here ? own.string() : recording.name});
    if (recording.payload) files.payloads.push_back({recording.name, *recording.payload});
  }
  if (files.logs.empty()) not_now("A recording to fit is missing: those that are held out judge.");
  const std::vector<std::string> missing = missing_of(*map_);
  if (!missing.empty()) not_now("Choose the column of " + list_of(missing) + " first.");
  files.robot = robot_to_use();
  if (!robot_->import_command.empty()) {
    files.commands_note +=
        fmt::format("{}The robot file is made by: {} -o {}", files.commands_note.empty() ? "" : " ",
                    robot_->import_command, shell_word(files.robot.name));
  }
  if (!map_is_of_robot_) {
    const std::string stem = std::filesystem::path(robot_->file.name).stem().string();
    files.channels = NamedFile{folder_.put("channels.toml", channels_table(*map_)).string(),
                               free_name(stem + "_channels", ".toml")};
  }
  return files;
}

std::vector<std::string> Intake::write(const SessionFiles& files) {
  std::vector<std::string> written;
  const auto write_as = [&](const NamedFile& file) {
    write_file_atomically(file.name, read_text_file(file.path), Existing::kRefuse);
    written.push_back(file.name);
  };
  if (!same_content(files.robot.path, files.robot.name)) write_as(files.robot);
  if (files.channels) {
    write_as(*files.channels);
    folder_.remove(files.channels->path);
  }
  return written;
}

ordered_json Intake::map_json() const {
  if (!map_) return nullptr;
  const std::vector<std::string> missing = missing_of(*map_);
  ordered_json columns = ordered_json::array();
  const NamedColumns& all = all_columns();
  for (const std::string& name : all.names) {
    if (all.columns.contains(name)) columns.push_back(name);
  }
  return {{"signals", signals_json(*map_, robot_->description, all)},
          {"columns", std::move(columns)},
          {"period_s", map_->period_s > 0 ? ordered_json(map_->period_s) : ordered_json(nullptr)},
          {"from", map_source_},
          {"is_of_robot", map_is_of_robot_},
          {"notes", notes_},
          {"without_numbers", others_},
          {"missing", missing},
          {"text", missing.empty() ? ordered_json(channels_table(*map_)) : ordered_json(nullptr)}};
}

ordered_json Intake::state_now() const {
  ordered_json recordings = ordered_json::array();
  for (const Recording& one : recordings_) {
    std::error_code ignored;
    recordings.push_back({{"id", one.id},
                          {"name", one.name},
                          {"bytes", std::filesystem::file_size(one.path, ignored)},
                          {"held_out", one.held_out},
                          {"payload", payload_json(one.payload)}});
  }
  const UploadLimits& limits = folder_.limits();
  return {{"revision", revision_},
          {"robot", robot_ ? to_json(*robot_) : ordered_json(nullptr)},
          {"urdf", urdf_ ? urdf_->json() : ordered_json(nullptr)},
          {"recordings", std::move(recordings)},
          {"limits",
           {{"file", limits.file},
            {"file_words", bytes_words(limits.file)},
            {"all", limits.all},
            {"all_words", bytes_words(limits.all)},
            {"used", folder_.used()}}},
          {"map", map_json()}};
}

}  // namespace offnominal::desk::studio
