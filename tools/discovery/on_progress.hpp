#pragma once

#include <functional>
#include <string>

namespace offnominal::tools::discovery {

// What is being done, for the one who waits.
using OnProgress = std::function<void(const std::string& doing)>;

}  // namespace offnominal::tools::discovery
