#include "studio/given_recording.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "common/error.hpp"
#include "log/channel_needs.hpp"
#include "log/read_log.hpp"
#include "log/time_of.hpp"
#include "robot/payload.hpp"

namespace offnominal::desk::studio {

using nlohmann::ordered_json;

namespace {

ordered_json payload_json(const std::optional<Payload>& payload) {
  if (!payload) return nullptr;
  return {{"mass_kg", payload->mass_kg},
          {"x_m", payload->place_m[0]},
          {"y_m", payload->place_m[1]},
          {"z_m", payload->place_m[2]},
          {"words", words_of(*payload)}};
}

template <typename TextOf>
std::string joined(const std::vector<GivenFile>& files, const TextOf& text_of) {
  std::string text;
  for (const GivenFile& file : files) text += (text.empty() ? "" : "+") + text_of(file);
  return text;
}

}  // namespace

GivenRecording::GivenRecording(std::vector<GivenFile> files, std::string why)
    : files_(std::move(files)), why_(std::move(why)) {
  if (files_.size() == 1) return;
  std::vector<const NamedColumns*> all;
  for (const GivenFile& file : files_) all.push_back(file.columns.get());
  together_ = named_together(all);
}

std::string GivenRecording::path() const {
  return joined(files_, [](const GivenFile& file) { return file.path.string(); });
}

std::string GivenRecording::name() const {
  return joined(files_, [](const GivenFile& file) { return file.name; });
}

const NamedColumns& GivenRecording::columns() const {
  return files_.size() == 1 ? *first().columns : together_;
}

const Eigen::VectorXd* GivenRecording::values_of(const std::string& source) const {
  for (std::size_t k = 0; k < files_.size(); ++k) {
    for (const auto& [name, values] : files_[k].columns->columns) {
      if (name == source || (files_.size() > 1 && name_in_file(k, name) == source)) return &values;
    }
  }
  return nullptr;
}

std::vector<SaidOfFile> GivenRecording::said() const {
  std::vector<SaidOfFile> said;
  for (const GivenFile& file : files_) {
    SaidOfFile one{file.held_out, file.payload, file.by_hand, file.wants};
    if (file.by_hand && file.id != id()) one.joined_to = first().of;
    said.push_back(std::move(one));
  }
  return said;
}

TimedColumns GivenRecording::timed(const ChannelMap& map) const {
  if (map.at_rest && files_.size() > 1) {
    throw InputError({columns().file, "", fmt::format("{} files", files_.size()),
                      "one, where the recordings are readings at rest", "take them apart"});
  }
  std::vector<TimedColumns> timed;
  for (std::size_t k = 0; k < files_.size(); ++k) {
    TimedColumns one{*files_[k].columns, {}};
    if (files_.size() > 1) {
      // What nobody reads need not be as long as the time, nor have a name that no other file has.
      const NeedOf need_of = needs_of(map, k, files_.size());
      std::erase_if(one.columns.columns,
                    [&](const auto& column) { return need_of(column.first) == Need::kNone; });
    }
    if (map.at_rest) return one;
    one.time = time_of(one.columns, time_channel(map, k), map.period_s);
    if (files_.size() == 1) return one;
    if (one.time.t_s.size() < 2) {
      throw InputError({one.columns.file, "", fmt::format("{} samples", one.time.t_s.size()),
                        "2 samples or more in each file of a recording", ""});
    }
    timed.push_back(std::move(one));
  }
  return joined_files(std::move(timed), kMinSamples, kMaxGap);
}

ordered_json GivenRecording::json() const {
  ordered_json files = ordered_json::array();
  std::uintmax_t all = 0;
  for (const GivenFile& file : files_) {
    std::error_code ignored;
    const std::uintmax_t bytes = std::filesystem::file_size(file.path, ignored);
    files.push_back({{"name", file.name}, {"bytes", bytes}});
    all += bytes;
  }
  return {{"id", id()},
          {"name", name()},
          {"bytes", all},
          {"files", std::move(files)},
          {"why_joined", why_},
          {"held_out", first().held_out},
          {"payload", payload_json(first().payload)}};
}

}  // namespace offnominal::desk::studio
