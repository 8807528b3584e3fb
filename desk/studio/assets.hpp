#pragma once

#include <string_view>

/// Files of desk/studio/web, of desk/studio/api and of the npm package three, held inside the
/// program.
namespace offnominal::desk::studio::assets {

std::string_view api();
std::string_view page();
std::string_view style();
std::string_view script();
std::string_view arm_view();
std::string_view orbit_controls();
std::string_view three();
std::string_view three_core();

}  // namespace offnominal::desk::studio::assets
