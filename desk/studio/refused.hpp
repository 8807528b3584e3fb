#pragma once

#include "common/refused.hpp"

namespace offnominal::desk::studio {

using desk::Refused;

}  // namespace offnominal::desk::studio
