#pragma once

#include <offnominal/status.hpp>
#include <ostream>

namespace offnominal {

// GoogleTest shows a status by its name.
inline void PrintTo(Status status, std::ostream* stream) { *stream << name_of(status); }

}  // namespace offnominal
