#include "studio/intake.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/nearest.hpp"
#include "common/refused.hpp"
#include "common/shell_word.hpp"
#include "robot/channel_text.hpp"
#include "robot/robot_file.hpp"
#include "studio/commands.hpp"
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

[[noreturn]] void not_now(const std::string& words) { throw Refused(Refused::Why::kNotNow, words); }

}  // namespace

Intake::Intake(IntakeSettings settings)
    : settings_(std::move(settings)), folder_(settings_.limits) {
  if (settings_.keeps_columns) kept_ = KeptColumns(here("studio_columns.json"));
  if (!settings_.robot_file) return;
  given_.use_robot(
      {read_robot_file(*settings_.robot_file), {*settings_.robot_file, *settings_.robot_file}});
}

ordered_json Intake::state() {
  const std::lock_guard guard(lock_);
  return state_now();
}

ordered_json Intake::change(const std::function<void(GivenFiles&)>& work) {
  const std::lock_guard guard(lock_);
  GivenFiles changed = given_;
  try {
    work(changed);
    take_up(changed);
  } catch (const InputError& error) {
    throw folder_.shown(error);
  }
  keep(changed);
  given_ = std::move(changed);
  ++revision_;
  return state_now();
}

void Intake::take_up(GivenFiles& changed) {
  const std::string of = changed.columns_of();
  if (of == given_.columns_of()) return;
  taken_up_.clear();
  if (!changed.said_of_columns().is_null()) return;
  const ordered_json said = kept_.columns(of);
  if (!said.is_null()) taken_up_ = changed.say_of_columns(said);
}

void Intake::keep(const GivenFiles& changed) {
  const ordered_json said = changed.said_of_columns();
  const bool is_other = changed.columns_of() != given_.columns_of();
  if (is_other ? !said.is_null() : said != given_.said_of_columns()) {
    kept_.keep_columns(changed.columns_of(), said);
    if (!is_other && said.is_null()) taken_up_.clear();
  }
  std::map<std::string, SaidOfFile> before;
  const auto each = [](const GivenFiles& given, const auto& take) {
    for (const GivenRecording& recording : given.recordings()) {
      const std::vector<SaidOfFile> all = recording.said();
      for (std::size_t i = 0; i < all.size(); ++i) take(recording.files()[i].of, all[i]);
    }
  };
  each(given_, [&](const std::string& of, const SaidOfFile& one) { before[of] = one; });
  each(changed, [&](const std::string& of, const SaidOfFile& one) {
    const auto known = before.find(of);
    if (known == before.end() || known->second == one) return;
    kept_.keep_file(of, one == SaidOfFile{} ? std::nullopt : std::optional(one));
  });
}

ordered_json Intake::take(const std::filesystem::path& file) {
  const std::string kind = lower_extension(file);
  try {
    return change([&](GivenFiles& given) {
      if (kind == ".toml") {
        use_robot(given, robot_of_toml(file));
        forget_urdf();
      } else if (kind == ".urdf") {
        take_urdf(given, file);
      } else {
        given.add(next_id_, file, kept_.file(content_fingerprint(file)).value_or(SaidOfFile{}));
        ++next_id_;
      }
    });
  } catch (...) {
    folder_.remove(file);
    throw;
  }
}

void Intake::take_urdf(GivenFiles& given, const std::filesystem::path& file) {
  GivenUrdf urdf(file);
  if (!urdf.has_choice()) {
    use_robot(given, urdf.robot(folder_));
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
  return change([&](GivenFiles& given) {
    if (!urdf_) throw Refused(Refused::Why::kNotNow, "There is no URDF with several chains.");
    use_robot(given, urdf_->robot(chain, folder_));
    urdf_->choose(chain);
  });
}

void Intake::use_robot(GivenFiles& given, GivenRobot robot) {
  const std::filesystem::path file = robot.file.path;
  try {
    given.use_robot(std::move(robot));
  } catch (...) {
    folder_.remove(file);
    throw;
  }
  if (given_.robot() && given_.robot()->file.path != file) {
    folder_.remove(given_.robot()->file.path);
  }
}

ordered_json Intake::remove(std::size_t id) {
  return change([&](GivenFiles& given) {
    for (const GivenFile& file : given.remove(id)) folder_.remove(file.path);
  });
}

ordered_json Intake::join(std::size_t id, std::size_t to) {
  return change([&](GivenFiles& given) { given.join(id, to); });
}

ordered_json Intake::split(std::size_t id) {
  return change([&](GivenFiles& given) { given.split(id); });
}

ordered_json Intake::set_held_out(std::size_t id, bool held_out) {
  return change([&](GivenFiles& given) { given.set_held_out(id, held_out); });
}

ordered_json Intake::set_payload(std::size_t id, const std::optional<Payload>& payload) {
  return change([&](GivenFiles& given) { given.set_payload(id, payload); });
}

ordered_json Intake::set_signal(const SignalEdit& edit) {
  return change([&](GivenFiles& given) { given.set_signal(edit); });
}

ordered_json Intake::set_at_rest(bool at_rest) {
  return change([&](GivenFiles& given) { given.set_at_rest(at_rest); });
}

ordered_json Intake::guess_again() {
  return change([](GivenFiles& given) { given.guess_again(); });
}

ordered_json Intake::preview(std::size_t id, std::size_t pixels) {
  const std::lock_guard guard(lock_);
  const GivenRecording& recording = given_.recording_of(id);
  const ChannelMap map = given_.map_of(recording);
  ordered_json json{{"revision", revision_}, {"recording", id}};
  json.update(preview_of(recording, given_.robot()->description, map, pixels));
  return json;
}

ordered_json Intake::findings(std::size_t id, std::size_t pixels) {
  const std::lock_guard guard(lock_);
  const GivenRecording& recording = given_.recording_of(id);
  const ChannelMap map = given_.map_of(recording);
  ordered_json json{{"revision", revision_}, {"recording", id}};
  json.update(findings_of(recording, given_.robot()->description, map, settings_.keep, pixels));
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
  NamedFile file = given_.robot()->file;
  if (settings_.robot_file && file.path == *settings_.robot_file) return file;
  file.name = here(file.name).string();
  if (!same_content(file.path, file.name)) {
    file.name = free_name(std::filesystem::path(file.name).stem().string(), ".toml");
  }
  return file;
}

// Under the name that its files have here, where all of them are here, else by their names alone.
NamedFile Intake::recording_to_use(const GivenRecording& recording, std::string& note) const {
  std::string own;
  for (const GivenFile& file : recording.files()) {
    const std::filesystem::path path = here(file.name);
    if (!same_content(file.path, path)) {
      note =
          "The recordings were dropped on the page: run these where they lie, or write their "
          "folders before their names.";
      return {recording.path(), recording.name()};
    }
    own += (own.empty() ? "" : "+") + path.string();
  }
  return {recording.path(), own};
}

SessionFiles Intake::files() {
  const std::lock_guard guard(lock_);
  if (given_.map() && given_.map()->at_rest) {
    not_now("There is no session over hold maps: write what is said of them, and explain them.");
  }
  return files_now();
}

ordered_json Intake::write_at_rest() {
  SessionFiles files;
  {
    const std::lock_guard guard(lock_);
    if (!given_.map() || !given_.map()->at_rest) not_now("There are no hold maps.");
    for (const GivenRecording& recording : given_.recordings()) {
      check_readable(recording, given_.robot()->description, given_.map_of(recording));
    }
    files = files_now();
  }
  std::vector<std::string> written = write(files);
  return {{"written", std::move(written)},
          {"commands", commands_at_rest(files)},
          {"note", files.commands_note}};
}

SessionFiles Intake::files_now() {
  if (!given_.robot()) not_now("A robot file is missing: drop a .toml or a .urdf.");
  SessionFiles files;
  for (const GivenRecording& recording : given_.recordings()) {
    const GivenFile& first = recording.first();
    auto& group = first.held_out ? files.holdout : files.logs;
    group.push_back(recording_to_use(recording, files.commands_note));
    if (files.kept_as.empty() && !first.held_out) files.kept_as = here(first.name).string();
    if (first.payload) files.payloads.push_back({first.name, *first.payload});
  }
  if (files.logs.empty()) not_now("A recording to fit is missing: those that are held out judge.");
  const std::vector<std::string> missing = missing_of(*given_.map());
  if (!missing.empty()) not_now("Choose the column of " + list_of(missing) + " first.");
  files.robot = robot_to_use();
  const GivenRobot& robot = *given_.robot();
  if (!robot.import_command.empty()) {
    files.commands_note +=
        fmt::format("{}The robot file is made by: {} -o {}", files.commands_note.empty() ? "" : " ",
                    robot.import_command, shell_word(files.robot.name));
  }
  if (!given_.map_is_of_robot()) {
    const std::string stem = std::filesystem::path(robot.file.name).stem().string();
    files.channels =
        NamedFile{folder_.put("channels.toml", channels_table(as_written(*given_.map()))).string(),
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

ordered_json Intake::state_now() const {
  ordered_json recordings = ordered_json::array();
  for (const GivenRecording& one : given_.recordings()) recordings.push_back(one.json());
  const UploadLimits& limits = folder_.limits();
  const auto& robot = given_.robot();
  return {{"revision", revision_},
          {"robot", robot ? to_json(*robot) : ordered_json(nullptr)},
          {"urdf", urdf_ ? urdf_->json() : ordered_json(nullptr)},
          {"recordings", std::move(recordings)},
          {"limits",
           {{"file", limits.file},
            {"file_words", bytes_words(limits.file)},
            {"all", limits.all},
            {"all_words", bytes_words(limits.all)},
            {"used", folder_.used()}}},
          {"kept", {{"file", kept_.name()}, {"problem", kept_.problem()}, {"taken_up", taken_up_}}},
          {"map", given_.map_json([&](const std::string& words) { return folder_.shown(words); })}};
}

}  // namespace offnominal::desk::studio
