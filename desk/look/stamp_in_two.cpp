#include "look/stamp_in_two.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "log/usable_rows.hpp"
#include "look/name_guess.hpp"
#include "look/nameless.hpp"
#include "robot/units.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

struct PartOfSecond {
  const char* unit;
  std::array<std::string_view, 6> words;
};
constexpr std::array kParts{
    PartOfSecond{"ns", {"nsec", "nsecs", "nanosec", "nanosecs", "nanoseconds", "ns"}},
    PartOfSecond{"us", {"usec", "usecs", "microsec", "microsecs", "microseconds", "us"}},
    PartOfSecond{"ms", {"msec", "msecs", "millisec", "millisecs", "milliseconds", "ms"}}};
constexpr std::array<std::string_view, 5> kSeconds{"sec", "secs", "second", "seconds", "s"};

bool are_whole(const VectorXd& x) {
  return x.size() > 1 && x.allFinite() && (x.array() == x.array().round()).all();
}

bool are_whole_seconds(const VectorXd& x) {
  return are_whole(x) && x[0] >= 0 && (x.tail(x.size() - 1) - x.head(x.size() - 1)).minCoeff() >= 0;
}

bool are_parts_of_seconds(const VectorXd& x, const char* unit) {
  return are_whole(x) && x.minCoeff() >= 0 && x.maxCoeff() * unit_factor(unit) < 1;
}

VectorXd sum_of(const VectorXd& seconds, const VectorXd& parts, const char* unit) {
  return (seconds.array() - seconds[0]).matrix() + unit_factor(unit) * parts;
}

// Parts that begin anew with each second, and no others: whatever the columns are called.
bool is_stamp(const VectorXd& seconds, const VectorXd& parts) {
  constexpr double kEpoch = 1e9;
  const bool goes_on = seconds[seconds.size() - 1] > seconds[0];
  if (!goes_on && !(seconds[0] >= kEpoch)) return false;
  for (Index i = 1; i < parts.size(); ++i) {
    if (parts[i] < parts[i - 1] && !(seconds[i] > seconds[i - 1])) return false;
  }
  return is_clock(sum_of(seconds, parts, "ns"));
}

std::optional<std::size_t> place_of_word(const std::vector<std::string>& words, const auto& known) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (std::find(known.begin(), known.end(), words[i]) != known.end()) return i;
  }
  return std::nullopt;
}

std::vector<std::string> word_texts(const std::string& name) {
  std::vector<std::string> texts;
  for (const NameWord& word : words_in(name)) texts.push_back(word.text);
  return texts;
}

class StampFinder {
 public:
  explicit StampFinder(const NamedColumns& columns) : columns_(columns) {}

  std::optional<Channel> by_names() const {
    for (const std::string& name : columns_.names) {
      for (const PartOfSecond& part : kParts) {
        std::vector<std::string> rest = word_texts(name);
        const auto at = place_of_word(rest, part.words);
        const VectorXd* const parts = values_of(name);
        if (!at || parts == nullptr || !are_parts_of_seconds(*parts, part.unit)) continue;
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(*at));
        if (const auto seconds = seconds_beside(rest, *parts, part.unit)) {
          return channel(*seconds, name, part.unit);
        }
      }
    }
    return std::nullopt;
  }

  std::optional<Channel> by_numbers() const {
    for (std::size_t i = 0; i + 1 < columns_.names.size(); ++i) {
      const VectorXd* const seconds = values_of(columns_.names[i]);
      const VectorXd* const parts = values_of(columns_.names[i + 1]);
      if (seconds == nullptr || parts == nullptr || seconds->size() != parts->size() ||
          !are_whole_seconds(*seconds) || !are_parts_of_seconds(*parts, "ns") ||
          !is_stamp(*seconds, *parts)) {
        continue;
      }
      return channel(columns_.names[i], columns_.names[i + 1], "ns");
    }
    return std::nullopt;
  }

 private:
  const VectorXd* values_of(const std::string& name) const {
    const auto found = columns_.columns.find(name);
    return found == columns_.columns.end() ? nullptr : &found->second;
  }

  // The column whose name is `rest`, with a word of seconds or without.
  std::optional<std::string> seconds_beside(const std::vector<std::string>& rest,
                                            const VectorXd& parts, const char* unit) const {
    for (const std::string& name : columns_.names) {
      std::vector<std::string> words = word_texts(name);
      if (const auto at = place_of_word(words, kSeconds)) {
        words.erase(words.begin() + static_cast<std::ptrdiff_t>(*at));
      }
      const VectorXd* const seconds = values_of(name);
      if (words == rest && seconds != nullptr && seconds->size() == parts.size() &&
          are_whole_seconds(*seconds) && ascends_as_time(sum_of(*seconds, parts, unit))) {
        return name;
      }
    }
    return std::nullopt;
  }

  static Channel channel(const std::string& seconds, const std::string& parts, const char* unit) {
    Channel sum;
    sum.sum.resize(2);
    sum.sum[0].source = seconds;
    sum.sum[1].source = parts;
    sum.sum[1].unit = unit;
    return sum;
  }

  const NamedColumns& columns_;
};

}  // namespace

std::optional<Channel> stamp_in_two(const NamedColumns& columns) {
  const StampFinder finder(columns);
  const auto named = columns.has_names ? finder.by_names() : std::nullopt;
  return named ? named : finder.by_numbers();
}

}  // namespace offnominal::desk
