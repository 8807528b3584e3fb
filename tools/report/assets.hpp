#pragma once

#include <string_view>

/// Files of tools/report/web, held inside the program.
namespace offnominal::tools::report::assets {

std::string_view page_template();
std::string_view style();
std::string_view script();
std::string_view echarts();

}  // namespace offnominal::tools::report::assets
