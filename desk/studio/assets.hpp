#pragma once

#include <string_view>

/// What desk/web makes Studio's page of, and the document of its API, held inside the program.
namespace offnominal::desk::studio::assets {

std::string_view api();
std::string_view page();
std::string_view style();
std::string_view script();
std::string_view arm_view();

}  // namespace offnominal::desk::studio::assets
