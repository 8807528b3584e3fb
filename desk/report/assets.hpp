#pragma once

#include <string_view>

/// What desk/web makes report pages of, held inside the program.
namespace offnominal::desk::report::assets {

std::string_view page_template();
std::string_view style();
std::string_view script();

}  // namespace offnominal::desk::report::assets
