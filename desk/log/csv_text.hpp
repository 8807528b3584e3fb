#pragma once

#include <string>

#include "log/log.hpp"

namespace offnominal::desk {

/// A recording in the common format: header t,q1..qn,dq1..dqn,tau1..taun, then the extra quantities
/// by name; SI units. Every number has as many digits as it takes to read the same one back.
[[nodiscard]] std::string csv_text(const Log& log);

}  // namespace offnominal::desk
