#pragma once

#include <string_view>

/// Files of desk/web, held inside the program.
namespace offnominal::desk::report::assets {

std::string_view page_template();
std::string_view style();
std::string_view script();
std::string_view echarts();

}  // namespace offnominal::desk::report::assets
