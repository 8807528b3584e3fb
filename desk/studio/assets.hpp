#pragma once

#include <string_view>

/// Files of desk/studio/web, held inside the program.
namespace offnominal::desk::studio::assets {

std::string_view page();
std::string_view style();
std::string_view script();

}  // namespace offnominal::desk::studio::assets
