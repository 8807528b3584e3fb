#include "studio/kept_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <system_error>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/json_text.hpp"
#include "robot/robot_file.hpp"
#include "studio/fingerprint.hpp"

namespace offnominal::desk::studio {

using nlohmann::ordered_json;

namespace {

constexpr const char* kMark = "offnominal_studio_session";
constexpr int kVersion = 1;

// As they are represented: the numbers of two files are the same to the bit, or others.
template <typename Dense>
void add_numbers(Fingerprint& print, const Dense& values) {
  const auto* const first = reinterpret_cast<const char*>(values.data());
  const auto bytes = static_cast<std::size_t>(values.size()) * sizeof(double);
  print.add(fmt::format("{}x{}:", values.rows(), values.cols()));
  print.add({first, bytes});
}

std::filesystem::path numbered(const std::filesystem::path& recording, int number) {
  std::filesystem::path file = recording;
  file.replace_filename(recording.stem().string() +
                        (number == 1 ? ".studio.json" : fmt::format(".studio_{}.json", number)));
  return file;
}

SessionState state_of(const ordered_json& json) {
  SessionState state;
  for (const ordered_json& step : json.at("steps")) {
    const auto joint = step.at("joint").get<std::size_t>();
    const auto kind = effect_named(step.at("effect").get<std::string>());
    // Of another version: what comes after it builds on it.
    if (!kind || joint < 1 || state.unknown > 0) {
      ++state.unknown;
      continue;
    }
    state.steps.push_back({0, *kind, joint - 1});
  }
  if (json.contains("look") && !json["look"].is_null()) state.view = view_from(json["look"]);
  state.answer = json.at("answer");
  state.answers_now = json.at("answers_now").get<bool>();
  return state;
}

ordered_json json_of(const SessionState& state, const std::string& of) {
  ordered_json steps = ordered_json::array();
  for (const Step& step : state.steps) {
    steps.push_back({{"effect", info_of(step.kind)->name}, {"joint", step.joint + 1}});
  }
  return {{kMark, kVersion},
          {"of", of},
          {"steps", std::move(steps)},
          {"look", state.view ? studio::json_of(*state.view) : ordered_json(nullptr)},
          {"answers_now", state.answers_now},
          {"answer", state.answer}};
}

// What a file holds of a session over such numbers; none: it is no such file.
struct Read {
  std::optional<SessionState> state;
  bool is_damaged = false;  // nobody can tell whose session it was
};
Read read(const std::filesystem::path& file, const std::string& of) {
  try {
    const ordered_json json = ordered_json::parse(read_text_file(file));
    if (json.at(kMark).get<int>() != kVersion || json.at("of").get<std::string>() != of) return {};
    return {state_of(json)};
  } catch (const ordered_json::exception&) {
    return {std::nullopt, true};
  }
}

std::string damage_words(const std::filesystem::path& damaged, const std::filesystem::path& file) {
  return fmt::format(
      "{} is empty, cut off or no session at all. It stays as it is; this session is kept in {}",
      damaged.filename().string(), file.filename().string());
}

}  // namespace

ordered_json json_of(const View& view) {
  const auto or_null = [](const auto& value) {
    return value ? ordered_json(*value) : ordered_json(nullptr);
  };
  return {{"joint", view.joint + 1},
          {"recording", view.recording + 1},
          {"beside", view.beside ? ordered_json(*view.beside + 1) : ordered_json(nullptr)},
          {"from", or_null(view.from_s)},
          {"to", or_null(view.to_s)}};
}

View view_from(const ordered_json& json) {
  // 0 becomes the largest number there is, which no check lets pass.
  const auto from_0 = [](const ordered_json& number) { return number.get<std::size_t>() - 1; };
  View view;
  view.joint = from_0(json.at("joint"));
  view.recording = from_0(json.at("recording"));
  if (const auto& beside = json.at("beside"); !beside.is_null()) view.beside = from_0(beside);
  if (const auto& from = json.at("from"); !from.is_null()) view.from_s = from.get<double>();
  if (const auto& to = json.at("to"); !to.is_null()) view.to_s = to.get<double>();
  return view;
}

std::uint64_t fingerprint_of(const Input& input) {
  Fingerprint hash;
  hash.add(robot_text(input.robot));
  hash.add(input.options);
  for (const RecordingPayload& payload : input.payloads) hash.add(text_of(payload));
  for (const auto* some : {&input.recordings->logs, &input.recordings->holdout}) {
    hash.add("recordings:");
    for (const Log& log : *some) {
      add_numbers(hash, log.t_s);
      add_numbers(hash, log.q);
      add_numbers(hash, log.dq);
      add_numbers(hash, log.tau);
      add_numbers(hash, log.sensor_tau);
      add_numbers(hash, log.approach);
      hash.add(fmt::format("{} left out", log.left_out.size()));
    }
  }
  return hash.value();
}

KeptSession::KeptSession(const std::filesystem::path& recording, const Input& input)
    : of_(fmt::format("{:016x}", fingerprint_of(input))) {
  constexpr int kMostTried = 100;
  std::optional<std::filesystem::path> damaged;
  try {
    for (int number = 1; number <= kMostTried; ++number) {
      const std::filesystem::path file = numbered(recording, number);
      std::error_code ignored;
      if (!std::filesystem::exists(std::filesystem::symlink_status(file, ignored))) {
        file_ = file;
        if (damaged) damaged_ = damage_words(*damaged, file);
        return;
      }
      const Read found = read(file, of_);
      if (found.is_damaged && !damaged) damaged = file;
      if (!found.state) continue;
      file_ = file;
      found_ = *found.state;
      return;
    }
    problem_ = "there are a hundred sessions beside the recording already";
  } catch (const InputError& error) {
    problem_ = on_one_line(error.what());
  }
}

void KeptSession::set_found_aside() {
  if (file_.empty()) return;
  std::filesystem::path aside = file_;
  aside += ".before";
  try {
    write_file_atomically(aside, read_text_file(file_), Existing::kReplace);
  } catch (const InputError& error) {
    problem_ = on_one_line(error.what());
    file_.clear();  // rather than lose what is there
  }
}

void KeptSession::keep(const SessionState& state) {
  if (file_.empty()) return;
  try {
    write_file_atomically(file_, json_text(json_of(state, of_)), Existing::kReplace);
    problem_.clear();
  } catch (const InputError& error) {
    problem_ = on_one_line(error.what());
  }
}

}  // namespace offnominal::desk::studio
