#pragma once

#include <optional>
#include <vector>

#include "explain/explain.hpp"
#include "identify/term.hpp"
#include "log/log.hpp"

namespace offnominal::desk {

// What the options say of when the robot may have become another one; none: nothing. Throws
// InputError, in the names of --after and --since, where that cannot be.
std::optional<TimeSpan> part_that_may_differ(const std::vector<Log>& logs,
                                             const ExplainOptions& options);

}  // namespace offnominal::desk
