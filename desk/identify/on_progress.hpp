#pragma once

#include <functional>
#include <string>

namespace offnominal::desk {

// What is being done, for the one who waits.
using OnProgress = std::function<void(const std::string& doing)>;

}  // namespace offnominal::desk
