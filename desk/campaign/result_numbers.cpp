#include "campaign/result_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace offnominal::desk::campaign {
namespace {

constexpr std::size_t kNumbers = 21;

template <typename Value>
double or_nan(const std::optional<Value>& value) {
  return value ? static_cast<double>(*value) : std::numeric_limits<double>::quiet_NaN();
}

std::optional<double> real_of(double number) {
  return std::isnan(number) ? std::nullopt : std::optional(number);
}

template <typename Value>
std::optional<Value> whole_of(double number) {
  if (std::isnan(number)) return std::nullopt;
  return static_cast<Value>(number);
}

}  // namespace

std::vector<double> numbers_of(const Campaign& campaign, const Result& result) {
  const auto at = std::find_if(campaign.detectors.begin(), campaign.detectors.end(),
                               [&](const auto& one) { return one.name == result.detector; });
  return {static_cast<double>(result.run),
          static_cast<double>(at - campaign.detectors.begin()),
          result.judged_s,
          result.detected ? 1.0 : 0.0,
          or_nan(result.delay_s),
          or_nan(result.first_joint),
          or_nan(result.joint_right),
          result.early ? 1.0 : 0.0,
          static_cast<double>(result.alarms),
          result.peak_before,
          result.peak_after,
          or_nan(result.tracking_before_rad),
          or_nan(result.tracking_after_rad),
          or_nan(result.ran_away_s),
          result.named ? static_cast<double>(result.named->kind) : or_nan(std::optional<int>()),
          result.named ? static_cast<double>(result.named->joint) : 0,
          result.named ? result.named->size : 0,
          result.named ? result.named->after_s : 0,
          or_nan(result.tracking_end_rad),
          or_nan(result.tracking_end_accommodated_rad),
          or_nan(result.moves_after_s)};
}

Result result_of(const Campaign& campaign, const std::vector<double>& numbers) {
  const auto is_below = [](double number, auto most) {
    return number >= 0 && number < static_cast<double>(most);
  };
  if (numbers.size() != kNumbers || !is_below(numbers[0], campaign.run_count()) ||
      !is_below(numbers[1], campaign.detectors.size())) {
    throw std::invalid_argument("no row of this campaign");
  }
  const Run run = run_of(campaign, static_cast<std::int64_t>(numbers[0]));
  Result result =
      row_of(campaign, run, campaign.detectors[static_cast<std::size_t>(numbers[1])].name);
  result.judged_s = numbers[2];
  result.detected = numbers[3] != 0;
  result.delay_s = real_of(numbers[4]);
  result.first_joint = whole_of<int>(numbers[5]);
  if (!std::isnan(numbers[6])) result.joint_right = numbers[6] != 0;
  result.early = numbers[7] != 0;
  result.alarms = static_cast<std::int64_t>(numbers[8]);
  result.peak_before = numbers[9];
  result.peak_after = numbers[10];
  result.tracking_before_rad = real_of(numbers[11]);
  result.tracking_after_rad = real_of(numbers[12]);
  result.ran_away_s = real_of(numbers[13]);
  if (!std::isnan(numbers[14])) {
    if (!is_below(numbers[14], offnominal::kFaultKinds))
      throw std::invalid_argument("no kind of fault");
    result.named = {static_cast<offnominal::FaultKind>(static_cast<int>(numbers[14])),
                    static_cast<int>(numbers[15]), numbers[16], numbers[17]};
  }
  result.tracking_end_rad = real_of(numbers[18]);
  result.tracking_end_accommodated_rad = real_of(numbers[19]);
  result.moves_after_s = real_of(numbers[20]);
  return result;
}

}  // namespace offnominal::desk::campaign
