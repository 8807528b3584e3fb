#include "studio/given_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/error.hpp"
#include "common/nearest.hpp"
#include "common/refused.hpp"
#include "log/channel_needs.hpp"
#include "look/look.hpp"
#include "look/looked_files.hpp"
#include "robot/channel_text.hpp"
#include "robot/payload_check.hpp"
#include "studio/file_groups.hpp"
#include "studio/fingerprint.hpp"

namespace offnominal::desk::studio {

using nlohmann::ordered_json;

namespace {

[[noreturn]] void refuse(Refused::Why why, const std::string& words) { throw Refused(why, words); }

std::shared_ptr<const NamedColumns> read_columns(const std::filesystem::path& file,
                                                 const std::optional<GivenRobot>& robot) {
  NamedColumns columns =
      read_looked_files(file, robot ? &robot->description : nullptr, std::nullopt).columns;
  columns.file = file.filename().string();
  return std::make_shared<const NamedColumns>(std::move(columns));
}

ordered_json names_with_numbers(const NamedColumns& columns) {
  ordered_json names = ordered_json::array();
  for (const std::string& name : columns.names) {
    if (columns.columns.contains(name)) names.push_back(name);
  }
  return names;
}

// Of a column of file `k` of several.
Channel in_file(Channel channel, std::size_t k, const NamedColumns& together) {
  const std::string whole = name_in_file(k, channel.source);
  const auto& names = together.names;
  if (std::find(names.begin(), names.end(), whole) != names.end()) channel.source = whole;
  return channel;
}

bool has_none(const std::vector<Channel>& channels) {
  return std::all_of(channels.begin(), channels.end(),
                     [](const Channel& one) { return one.source.empty() && one.sum.empty(); });
}

// What one file proposes of the joints, where those before it have nothing to say of it.
void take_proposal(ChannelMap& map, ChannelMap of_file, std::size_t k, std::size_t joints,
                   const NamedColumns& together) {
  const auto take = [&](std::vector<Channel>& to, std::vector<ChannelOf>& to_of,
                        std::vector<Channel>& from, std::vector<ChannelOf>& from_of) {
    if (!has_none(to) || from.size() != joints) return;
    for (Channel& one : from) one = in_file(std::move(one), k, together);
    to = std::move(from);
    to_of = std::move(from_of);
  };
  take(map.position, map.position_of, of_file.position, of_file.position_of);
  take(map.torque, map.torque_of, of_file.torque, of_file.torque_of);
  const auto is_known = [](const auto& one) { return one.has_value(); };
  const bool any_known = std::any_of(map.velocity.begin(), map.velocity.end(), is_known);
  if (any_known || of_file.velocity.size() != joints) return;
  for (auto& one : of_file.velocity) {
    if (one) one = in_file(*std::move(one), k, together);
  }
  map.velocity = std::move(of_file.velocity);
  map.velocity_of = std::move(of_file.velocity_of);
}

}  // namespace

void GivenFiles::use_robot(GivenRobot robot) {
  robot_ = std::move(robot);
  // How a log of a bus is decoded may follow from the robot file.
  for (GivenRecording& recording : recordings_) {
    std::vector<GivenFile> files = recording.files();
    for (GivenFile& file : files) file.columns = read_columns(file.path, robot_);
    recording = GivenRecording(std::move(files), recording.why());
  }
  arrange();
  set_map_aside();
  guess();
}

void GivenFiles::add(std::size_t id, const std::filesystem::path& file, const SaidOfFile& said) {
  GivenFile added;
  added.of = content_fingerprint(file);
  added.by_hand = said.by_hand && said.joined_to.empty();
  added.wants = said.joined_to;
  added.held_out = said.held_out;
  added.payload = said.payload;
  added.id = id;
  added.path = file;
  added.name = file.filename().string();
  for (const GivenRecording& recording : recordings_) {
    for (const GivenFile& other : recording.files()) {
      if (other.name != added.name) continue;
      throw InputError({added.name, "", "a recording of that name that is there already",
                        "names that differ", "take the other one away, or give this one another"});
    }
  }
  added.columns = read_columns(file, robot_);
  recordings_.emplace_back(std::vector{std::move(added)});
  join_as_before();
  arrange();
  guess();
}

std::vector<GivenFile> GivenFiles::remove(std::size_t id) {
  std::vector<GivenFile> gone = recording_of(id).files();
  std::erase_if(recordings_, [&](const GivenRecording& one) { return one.id() == id; });
  if (recordings_.empty()) set_map_aside();
  arrange();
  guess();
  return gone;
}

void GivenFiles::join(std::size_t id, std::size_t to) {
  if (id == to) refuse(Refused::Why::kBadRequest, "A recording is joined to another one.");
  std::vector<GivenFile> files = recording_of(to).files();
  const std::vector<GivenFile>& further = recording_of(id).files();
  files.insert(files.end(), further.begin(), further.end());
  for (GivenFile& file : files) {
    file.by_hand = true;
    file.wants.clear();
  }
  recording_at(to) = GivenRecording(std::move(files));
  std::erase_if(recordings_, [&](const GivenRecording& one) { return one.id() == id; });
  arrange();
  guess();
}

void GivenFiles::join_as_before() {
  const auto first_of = [&](const std::string& of) {
    return std::find_if(recordings_.begin(), recordings_.end(),
                        [&](const GivenRecording& one) { return one.first().of == of; });
  };
  for (std::size_t i = 0; i < recordings_.size();) {
    const GivenFile& file = recordings_[i].first();
    const auto to = file.wants.empty() ? recordings_.end() : first_of(file.wants);
    if (to == recordings_.end() || to->id() == file.id) {
      ++i;
      continue;
    }
    join(file.id, to->id());
    i = 0;
  }
}

void GivenFiles::split(std::size_t id) {
  std::vector<GivenFile> files = recording_of(id).files();
  if (files.size() == 1) refuse(Refused::Why::kNotNow, "The recording has one file alone.");
  std::erase_if(recordings_, [&](const GivenRecording& one) { return one.id() == id; });
  for (GivenFile& file : files) {
    file.by_hand = true;
    file.wants.clear();
    recordings_.emplace_back(std::vector{std::move(file)});
  }
  arrange();
  guess();
}

void GivenFiles::set_held_out(std::size_t id, bool held_out) {
  recording_at(id).first().held_out = held_out;
}

void GivenFiles::set_payload(std::size_t id, const std::optional<Payload>& payload) {
  GivenFile& file = recording_at(id).first();
  if (payload) check_payload({file.name, *payload});
  file.payload = payload;
}

void GivenFiles::set_signal(const SignalEdit& edit) {
  if (!map_) refuse(Refused::Why::kNotNow, "There is no recording and robot file yet.");
  studio::set_signal(*map_, edit, robot_->description, columns());
  said_.insert(edit.key());
  std::erase_if(waiting_, [&](const SaidSignal& one) { return one.key == edit.key(); });
  map_is_of_robot_ = false;
}

void GivenFiles::set_at_rest(bool at_rest) {
  if (!map_) refuse(Refused::Why::kNotNow, "There is no recording and robot file yet.");
  map_->at_rest = at_rest;
  said_at_rest_ = at_rest;
  map_is_of_robot_ = false;
}

void GivenFiles::guess_again() {
  map_.reset();
  said_.clear();
  said_at_rest_.reset();
  waiting_.clear();
  guess();
}

std::string GivenFiles::columns_of() const {
  if (!map_) return {};
  Fingerprint print;
  for (const RobotJoint& joint : robot_->description.joints) print.add(joint.name + "\n");
  std::vector<std::string> names = columns().all.names;
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) print.add("\t" + name + "\n");
  return fmt::format("{:016x}", print.value());
}

ordered_json GivenFiles::said_of_columns() const {
  if (!map_) return nullptr;
  ordered_json signals = ordered_json::array();
  for (const SaidSignal& one : said_of(*map_, said_)) signals.push_back(json_of(one));
  for (const SaidSignal& one : waiting_) signals.push_back(json_of(one));
  if (signals.empty() && !said_at_rest_) return nullptr;
  return {{"at_rest", said_at_rest_ ? ordered_json(*said_at_rest_) : ordered_json(nullptr)},
          {"signals", std::move(signals)}};
}

std::string GivenFiles::say_of_columns(const ordered_json& said) {
  const std::set<SignalKey> before = said_;
  try {
    for (const ordered_json& one : said.at("signals")) {
      if (auto signal = said_from(one)) waiting_.push_back(*std::move(signal));
    }
    if (const ordered_json& at_rest = said.at("at_rest"); !at_rest.is_null()) {
      said_at_rest_ = at_rest.get<bool>();
    }
  } catch (const ordered_json::exception&) {
    waiting_.clear();  // of another program: as if nothing had been kept
    return {};
  }
  take_up();
  std::vector<std::string> words;
  if (said_at_rest_) {
    words.emplace_back(*said_at_rest_ ? "that they are readings at rest"
                                      : "that they are recordings in time");
  }
  for (const SignalKey& key : said_) {
    if (!before.contains(key)) words.push_back(words_of(key));
  }
  return list_of(words);
}

const GivenRecording& GivenFiles::recording_of(std::size_t id) const {
  for (const GivenRecording& recording : recordings_) {
    if (recording.id() == id) return recording;
  }
  refuse(Refused::Why::kBadRequest, "There is no such recording.");
}

GivenRecording& GivenFiles::recording_at(std::size_t id) {
  const GivenRecording& found = recording_of(id);
  return recordings_[static_cast<std::size_t>(&found - recordings_.data())];
}

ChannelMap GivenFiles::map_of(const GivenRecording& recording) const {
  if (!map_) refuse(Refused::Why::kNotNow, "There is no robot file yet.");
  ChannelMap map = *map_;
  const GivenFile& first = recording.first();
  if (first.payload) map.payloads = {{first.name, *first.payload}};
  return map;
}

MappedColumns GivenFiles::columns() const {
  const GivenRecording& recording = recordings_.front();
  std::vector<const NamedColumns*> apart;
  for (const GivenFile& file : recording.files()) apart.push_back(file.columns.get());
  return {recording.columns(), std::move(apart)};
}

void GivenFiles::arrange() {
  std::vector<GivenFile> files;
  std::vector<GivenRecording> arranged;
  for (GivenRecording& recording : recordings_) {
    if (recording.is_by_hand() || !robot_) {
      arranged.push_back(std::move(recording));
      continue;
    }
    for (const GivenFile& file : recording.files()) files.push_back(file);
  }
  const auto by_id = [](const auto& a, const auto& b) { return a.id < b.id; };
  std::sort(files.begin(), files.end(), by_id);
  std::vector<FileToGroup> all;
  for (const GivenFile& file : files) {
    all.push_back({file.name, signals_in(*file.columns, robot_->description)});
  }
  for (const std::vector<std::size_t>& group : groups_of(all)) {
    std::vector<GivenFile> of_one;
    std::vector<FileToGroup> why;
    for (const std::size_t i : group) {
      of_one.push_back(files[i]);
      why.push_back(all[i]);
    }
    arranged.emplace_back(std::move(of_one), group.size() == 1 ? "" : words_of(why));
  }
  std::sort(arranged.begin(), arranged.end(),
            [&](const auto& a, const auto& b) { return by_id(a.first(), b.first()); });
  recordings_ = std::move(arranged);
}

void GivenFiles::guess() {
  if (!robot_ || recordings_.empty()) return;
  const bool is_joined = recordings_.front().files().size() > 1;
  const std::vector<std::string> names =
      is_joined ? recordings_.front().columns().names : std::vector<std::string>();
  if (map_ && names == of_names_) return;
  set_map_aside();
  of_names_ = names;
  propose();
  // Also where the robot file's own do not read this one.
  const auto& own = robot_->description.channels;
  map_->at_rest = own && own->at_rest;
  take_up();
}

void GivenFiles::set_map_aside() {
  if (!map_) return;
  const std::vector<SaidSignal> said = said_of(*map_, said_);
  waiting_.insert(waiting_.end(), said.begin(), said.end());
  said_.clear();
  map_.reset();
}

void GivenFiles::take_up() {
  if (said_at_rest_ && *said_at_rest_ != map_->at_rest) {
    map_->at_rest = *said_at_rest_;
    map_is_of_robot_ = false;
  }
  const std::vector<SaidSignal> said = std::exchange(waiting_, {});
  for (const SaidSignal& one : said) {
    if (say_again(one, *map_, columns())) {
      said_.insert(one.key);
      map_is_of_robot_ = false;
    } else {
      waiting_.push_back(one);
    }
  }
  if (waiting_.empty()) return;
  notes_.push_back("what was said of " +
                   list_of(waiting_, [](const SaidSignal& one) { return words_of(one.key); }) +
                   " is left out as long as there is no such column, joint or file");
}

void GivenFiles::propose() {
  const RobotDescription& robot = robot_->description;
  const GivenRecording& recording = recordings_.front();
  const std::size_t count = recording.files().size();
  notes_.clear();
  unread_.clear();
  Look look;
  try {
    look = look_at(recording.path(), &robot, std::nullopt);
  } catch (const InputError& error) {
    if (count == 1) throw;
    return propose_apart(robot);
  }
  map_is_of_robot_ = !look.by_robot.empty();
  map_source_ = map_is_of_robot_ ? "the robot file's own [channels]"
                : look.guessed   ? "the numbers: the file has no names that say anything"
                                 : "the columns' names";
  if (!look.t_s && look.channels.period_s == 0) look.channels.time = {};
  if (!map_is_of_robot_) look.channels.extra.clear();
  map_ = with_all_joints(std::move(look.channels), robot.joints.size(), count);
  notes_ = std::move(look.notes);
  unread_ = std::move(look.unread);
}

void GivenFiles::propose_apart(const RobotDescription& robot) {
  RobotDescription nameless = robot;
  nameless.channels.reset();
  const GivenRecording& recording = recordings_.front();
  const std::size_t joints = robot.joints.size();
  ChannelMap map = with_all_joints({}, joints);
  for (std::size_t k = 0; k < recording.files().size(); ++k) {
    Look look;
    try {
      look = look_at(recording.files()[k].path, &nameless, std::nullopt);
    } catch (const InputError& error) {
      notes_.emplace_back(error.what());
    }
    if (!look.t_s) look.channels.time = {};
    (k == 0 ? map.time : map.more_times.emplace_back()) = look.channels.time;
    unread_.insert(unread_.end(), look.unread.begin(), look.unread.end());
    take_proposal(map, std::move(look.channels), k, joints, recording.columns());
  }
  map_ = std::move(map);
  map_is_of_robot_ = false;
  map_source_ = "the columns' names, file by file";
}

ordered_json GivenFiles::map_json(
    const std::function<std::string(const std::string&)>& shown) const {
  if (!map_) return nullptr;
  const std::vector<std::string> missing = missing_of(*map_);
  const MappedColumns all = columns();
  ordered_json of_files = ordered_json::array();
  for (const NamedColumns* file : all.files) of_files.push_back(names_with_numbers(*file));
  ordered_json notes = ordered_json::array();
  for (const std::string& note : notes_) notes.push_back(shown(note));
  return {{"signals", signals_json(*map_, robot_->description, all)},
          {"columns", names_with_numbers(all.all)},
          {"columns_of_files", std::move(of_files)},
          {"at_rest", map_->at_rest},
          {"period_s", map_->period_s > 0 ? ordered_json(map_->period_s) : ordered_json(nullptr)},
          {"from", map_source_},
          {"is_of_robot", map_is_of_robot_},
          {"notes", std::move(notes)},
          {"without_numbers", unread_},
          {"missing", missing},
          {"text", missing.empty() ? ordered_json(channels_table(as_written(*map_)))
                                   : ordered_json(nullptr)}};
}

}  // namespace offnominal::desk::studio
