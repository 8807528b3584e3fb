#include "explain/taken_back.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "explain/sizes.hpp"

namespace offnominal::desk {

bool takes_back_what_raises(const Judged& by, const ImprovedRobot& improved,
                            const SearchSetting& setting, int threads, FoundModel& found) {
  const auto is_asked = [](const Accepted& one) {
    return !one.term.effect->is_mass() && !one.term.effect->info().traits.every_drive_has;
  };
  const auto& accepted = found.accepted;
  if (setting.data->recordings[0].at_rest ||
      std::none_of(accepted.begin(), accepted.end(), is_asked)) {
    return false;
  }
  const std::vector<double>& before = by.errors_of_file().rms_error;
  const std::vector<double> after = by.errors_of(improved.robot).rms_error;
  for (std::size_t i = accepted.size(); i-- > 0;) {
    const auto joint = static_cast<std::size_t>(accepted[i].term.joint);
    const bool is_written = i < improved.added.size() && improved.added[i] != kUnwritten;
    if (!is_asked(accepted[i]) || !is_written || !(after[joint] > before[joint])) continue;
    leave_out(i, *setting.regression, *setting.hold_out, threads, found);
    return true;
  }
  return false;
}

bool takes_back_what_drives(const ImprovedRobot& improved, const SearchSetting& setting,
                            int threads, FoundModel& found) {
  const auto& driven = improved.driven;
  for (std::size_t i = found.accepted.size(); i-- > 0;) {
    const Term& term = found.accepted[i].term;
    const EffectTraits& traits = term.effect->info().traits;
    const bool may_drive = traits.is_friction && traits.sign != CoefficientSign::kPositive;
    if (!may_drive || !traits.passes_for_friction ||
        std::find(driven.begin(), driven.end(), term.joint) == driven.end()) {
      continue;
    }
    leave_out(i, *setting.regression, *setting.hold_out, threads, found);
    return true;
  }
  return false;
}

}  // namespace offnominal::desk
