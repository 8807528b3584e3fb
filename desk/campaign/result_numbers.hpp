#pragma once

#include <vector>

#include "campaign/campaign.hpp"
#include "campaign/score.hpp"

namespace offnominal::desk::campaign {

/// A row as plain numbers, for processes that hand rows to each other: what follows from the
/// campaign is left out, NaN stands for what is not there.
[[nodiscard]] std::vector<double> numbers_of(const Campaign& campaign, const Result& result);

/// The row again, to the bit. Throws std::invalid_argument for numbers that are of no row of this
/// campaign.
[[nodiscard]] Result result_of(const Campaign& campaign, const std::vector<double>& numbers);

}  // namespace offnominal::desk::campaign
