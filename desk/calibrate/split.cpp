#include "calibrate/split.hpp"

#include <algorithm>

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

}  // namespace offnominal::desk
