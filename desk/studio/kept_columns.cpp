#include "studio/kept_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>
#include <utility>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/json_text.hpp"
#include "robot/payload_check.hpp"
#include "studio/fingerprint.hpp"

namespace offnominal::desk::studio {

using nlohmann::ordered_json;

namespace {

constexpr const char* kColumnsMark = "offnominal_studio_columns";
constexpr int kColumnsVersion = 1;
constexpr const char* kColumns = "columns";
constexpr const char* kFiles = "files";

ordered_json empty_file() {
  return {{kColumnsMark, kColumnsVersion},
          {kColumns, ordered_json::array()},
          {kFiles, ordered_json::array()}};
}

// Throws InputError where it is no such file, which is left alone then.
ordered_json content_of(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(std::filesystem::symlink_status(file, ignored))) {
    return empty_file();
  }
  ordered_json json = ordered_json::parse(read_text_file(file), nullptr, false);
  const auto is_list = [&](const char* kind) {
    return json.contains(kind) && json[kind].is_array();
  };
  const bool is_known =
      json.is_object() && json.contains(kColumnsMark) && json[kColumnsMark] == kColumnsVersion;
  if (!is_known || !is_list(kColumns) || !is_list(kFiles)) {
    throw InputError({file.string(), "", "something else, or of another version of Studio",
                      "what Studio keeps of dropped files", "move it away"});
  }
  return json;
}

bool is_of(const ordered_json& entry, const std::string& of) {
  return entry.is_object() && entry.contains("of") && entry["of"] == of;
}

ordered_json json_of(const std::optional<Payload>& payload) {
  if (!payload) return nullptr;
  const auto& place = payload->place_m;
  return {{"mass_kg", payload->mass_kg}, {"place_m", {place[0], place[1], place[2]}}};
}

}  // namespace

bool operator==(const SaidOfFile& a, const SaidOfFile& b) {
  return a.held_out == b.held_out && a.by_hand == b.by_hand && a.joined_to == b.joined_to &&
         json_of(a.payload) == json_of(b.payload);
}

KeptColumns::KeptColumns(std::filesystem::path file) : file_(std::move(file)) {}

ordered_json KeptColumns::entry(const char* kind, const std::string& of) const {
  if (file_.empty() || of.empty()) return nullptr;
  try {
    const ordered_json all = content_of(file_);
    for (const ordered_json& one : all[kind]) {
      if (is_of(one, of) && one.contains("said")) return one["said"];
    }
  } catch (const InputError&) {
    return nullptr;  // the next change says why
  }
  return nullptr;
}

void KeptColumns::keep(const char* kind, const std::string& of, ordered_json said) {
  if (file_.empty() || of.empty()) return;
  try {
    // Another program may have written since.
    ordered_json all = content_of(file_);
    ordered_json kept = ordered_json::array();
    if (!said.is_null()) kept.push_back({{"of", of}, {"said", std::move(said)}});
    for (ordered_json& one : all[kind]) {
      if (!is_of(one, of) && kept.size() < kMost) kept.push_back(std::move(one));
    }
    all[kind] = std::move(kept);
    write_file_atomically(file_, json_text(all), Existing::kReplace);
    problem_.clear();
  } catch (const InputError& error) {
    problem_ = on_one_line(error.what());
  }
}

ordered_json KeptColumns::columns(const std::string& of) const { return entry(kColumns, of); }

void KeptColumns::keep_columns(const std::string& of, const ordered_json& said) {
  keep(kColumns, of, said);
}

std::optional<SaidOfFile> KeptColumns::file(const std::string& of) const {
  const ordered_json said = entry(kFiles, of);
  if (said.is_null()) return std::nullopt;
  try {
    SaidOfFile file;
    file.held_out = said.at("held_out").get<bool>();
    file.by_hand = said.at("by_hand").get<bool>();
    file.joined_to = said.at("joined_to").get<std::string>();
    if (const ordered_json& payload = said.at("payload"); !payload.is_null()) {
      file.payload = Payload{payload.at("mass_kg").get<double>(),
                             payload.at("place_m").get<std::array<double, 3>>()};
    }
    if (file.payload) check_payload({of, *file.payload});
    return file;
  } catch (const ordered_json::exception&) {
    return std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

void KeptColumns::keep_file(const std::string& of, const std::optional<SaidOfFile>& said) {
  if (!said) return keep(kFiles, of, nullptr);
  keep(kFiles, of,
       {{"held_out", said->held_out},
        {"payload", json_of(said->payload)},
        {"by_hand", said->by_hand},
        {"joined_to", said->joined_to}});
}

std::string content_fingerprint(const std::filesystem::path& file) {
  constexpr std::uintmax_t kEnds = 1 << 20;  // bytes
  std::error_code failure;
  const std::uintmax_t size = std::filesystem::file_size(file, failure);
  std::ifstream stream(file, std::ios::binary);
  if (failure || !stream) return {};
  Fingerprint print;
  print.add(fmt::format("{}:", size));
  std::string part(static_cast<std::size_t>(std::min(size, kEnds)), '\0');
  for (const std::uintmax_t at : {std::uintmax_t{0}, size - part.size()}) {
    stream.seekg(static_cast<std::streamoff>(at));
    stream.read(part.data(), static_cast<std::streamsize>(part.size()));
    print.add(part);
  }
  return fmt::format("{:016x}", print.value());
}

}  // namespace offnominal::desk::studio
