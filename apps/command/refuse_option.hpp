#pragma once

#include <string>

namespace offnominal::desk {

// Throws InputError: the verb ("add") cannot take what an option ("-o") was given.
[[noreturn]] void refuse_option(const std::string& verb, const std::string& option,
                                const std::string& found, const std::string& allowed,
                                const std::string& mend = {});

}  // namespace offnominal::desk
