#include "log/time_of.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "common/error.hpp"
#include "common/time_words.hpp"
#include "log/column_values.hpp"
#include "log/usable_rows.hpp"
#include "robot/units.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

struct Epoch {
  double per_second;
  const char* unit;
  const char* words;
};
constexpr std::array kEpochs{Epoch{1e3, "ms", "milliseconds"}, Epoch{1e6, "us", "microseconds"},
                             Epoch{1e9, "ns", "nanoseconds"}};

// From 2001 to 2065; no clock that counts seconds comes near.
const Epoch* epoch_of(double first) {
  for (const Epoch& epoch : kEpochs) {
    const double seconds = first / epoch.per_second;
    if (seconds >= 1e9 && seconds < 3e9) return &epoch;
  }
  return nullptr;
}

// The samples of a file without a time.
Index samples_of(const NamedColumns& columns) {
  Index most = 0;
  for (const auto& [name, values] : columns.columns) most = std::max(most, values.size());
  return most;
}

bool says_unit(const Channel& channel) {
  return !channel.unit.empty() || channel.scale != 1 || !channel.scale_source.empty();
}

void leave_out_rows_out_of_time(NamedColumns& columns, FileTime& time) {
  const Index rows = time.t_s.size();
  std::vector<Index> kept = ascending_rows(time.t_s);
  const Index left_out = rows - static_cast<Index>(kept.size());
  if (left_out == 0) return;
  Index first = 0;
  while (first < static_cast<Index>(kept.size()) &&
         kept[static_cast<std::size_t>(first)] == first) {
    ++first;
  }
  const std::string place = columns.place_of(first) + ", time";
  const std::string found = first == 0
                                ? fmt::format("{} s", words_of_time(time.t_s[first]))
                                : fmt::format("{} s after {} s", words_of_time(time.t_s[first]),
                                              words_of_time(time.t_s[first - 1]));
  if (static_cast<double>(left_out) > kMostRowsOutOfTime * static_cast<double>(rows)) {
    throw InputError({columns.file, place, found, "time that ascends from sample to sample",
                      "cut the recording where its clock begins anew, or say its step: --period"});
  }
  columns.remarks.push_back(
      fmt::format("{} row{} whose time does not ascend {} left out: {} first, {}", left_out,
                  left_out == 1 ? "" : "s", left_out == 1 ? "is" : "are", place, found));
  VectorXd ascending(static_cast<Index>(kept.size()));
  for (Index i = 0; i < ascending.size(); ++i) {
    ascending[i] = time.t_s[kept[static_cast<std::size_t>(i)]];
  }
  time.t_s = std::move(ascending);
  keep_rows(columns, rows, kept);
  time.rows = std::move(kept);
}

}  // namespace

FileTime time_of(NamedColumns& columns, const Channel& channel, double period_s) {
  const auto fail = [&](const std::string& place, const std::string& found,
                        const std::string& allowed, const std::string& mend) {
    throw InputError({columns.file, place, found, allowed, mend});
  };
  FileTime time;
  if (period_s > 0) {
    const Index samples = samples_of(columns);
    time.t_s.resize(samples);
    for (Index i = 0; i < samples; ++i) time.t_s[i] = static_cast<double>(i) * period_s;
    return time;
  }
  Channel as_said = channel;
  if (const auto unit = columns.units.find(channel.source);
      unit != columns.units.end() && !says_unit(channel) && find_unit(unit->second) != nullptr) {
    take_unit_of_file(columns, as_said, ChannelQuantity::kTime, "time");
  }
  if (const auto origin = columns.origins.find(channel.source); origin != columns.origins.end()) {
    if (origin->second.is_date && says_unit(channel)) {
      fail("column " + channel.source, "dates", "numbers, where a unit or a scale is said of them",
           "leave unit and scale out");
    }
    if (origin->second.is_date) as_said.unit.clear();
    time.origin_s = origin->second.value * as_said.scale * unit_factor(as_said.unit);
  }
  const auto found = columns.columns.find(channel.source);
  if (found != columns.columns.end() && found->second.size() > 0 && !says_unit(as_said)) {
    const auto origin = columns.origins.find(channel.source);
    const bool is_date = origin != columns.origins.end() && origin->second.is_date;
    const double first = origin == columns.origins.end() ? found->second[0] : origin->second.value;
    if (const Epoch* epoch = is_date ? nullptr : epoch_of(first)) {
      fail(columns.place_of(0) + ", " + channel.source,
           fmt::format("{:.6g}, {} since 1970 by its size", first, epoch->words), "a time in s",
           fmt::format("say its unit: [channels] with time = {{source = \"{}\", unit = \"{}\"}}",
                       channel.source, epoch->unit));
    }
  }
  time.t_s = take_values(columns, as_said, kTimeWords, true);
  time.channel = as_said;
  leave_out_rows_out_of_time(columns, time);
  return time;
}

}  // namespace offnominal::desk
