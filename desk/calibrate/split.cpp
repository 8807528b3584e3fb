#include "calibrate/split.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "log/part_of.hpp"

namespace offnominal::desk {
namespace {

constexpr Eigen::Index kFifths = 5;

}  // namespace

Split split(const std::vector<RecordedError>& recordings, std::size_t given, double settling_s) {
  Split result;
  const auto whole = [&](std::size_t i) { return SampleRange{i, 0, recordings[i].samples()}; };
  for (std::size_t i = given; i < recordings.size(); ++i) result.held_out.push_back(whole(i));
  const bool none = result.held_out.empty();
  const std::size_t fitted = none && given > 1 ? given - 1 : given;
  if (none && given > 1) result.held_out.push_back(whole(fitted));
  for (std::size_t i = 0; i < fitted; ++i) result.folds.push_back(whole(i));
  if (result.folds.size() > 1) return result;
  SampleRange only = result.folds.front();
  if (result.held_out.empty()) {
    const Eigen::Index kept = only.end - only.end / kFifths;
    result.held_out.push_back({0, kept, only.end});
    only.end = kept;
  }
  const auto settling = static_cast<Eigen::Index>(settling_s / recordings.front().period_s) + 1;
  const Eigen::Index begin = std::min(settling, only.end);
  const Eigen::Index rest = only.end - begin;
  result.always.push_back({0, 0, begin});
  result.folds.clear();
  for (Eigen::Index part = 0; part < kFifths; ++part) {
    result.folds.push_back({0, begin + part * rest / kFifths, begin + (part + 1) * rest / kFifths});
  }
  return result;
}

std::vector<Log> take_held_out(std::vector<Log>& parts, double shortest_s) {
  const std::string last = parts.back().file;
  const auto first =
      std::find_if(parts.begin(), parts.end(), [&](const Log& part) { return part.file == last; });
  std::vector<Log> held_out;
  if (first != parts.begin()) {
    held_out.assign(std::make_move_iterator(first), std::make_move_iterator(parts.end()));
    parts.erase(first, parts.end());
    return held_out;
  }
  if (parts.size() == 1) return held_out;
  Eigen::Index missing = 0;
  for (const Log& part : parts) missing += part.sample_count();
  missing /= kFifths;
  const auto is_long = [&](Eigen::Index samples) {
    return static_cast<double>(samples) * parts.front().period_s >= shortest_s;
  };
  while (held_out.empty() || is_long(missing)) {
    Log& part = parts.back();
    const Eigen::Index samples = part.sample_count();
    if (is_long(missing) && is_long(samples - missing)) {
      held_out.insert(held_out.begin(), part_of(part, {samples - missing, samples - 1}));
      part = part_of(part, {0, samples - missing - 1});
      break;
    }
    if (parts.size() == 1) break;
    missing -= samples;
    held_out.insert(held_out.begin(), std::move(part));
    parts.pop_back();
  }
  return held_out;
}

}  // namespace offnominal::desk
