#pragma once

#include "report/page.hpp"

namespace offnominal::desk::report {

/// True for the formats that kDefaultFormat's comment allows.
bool is_number_format(const std::string& format);

/// Throws std::invalid_argument naming the block and its fault when the page contradicts itself
/// (see to_json()).
void validate(const Page& page);

}  // namespace offnominal::desk::report
