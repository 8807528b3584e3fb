#pragma once

#include <string>

namespace CLI {
class App;
}

namespace offnominal::desk {

/// How to mend the first word of a command line that looks like an option of `verb` and is none:
/// "write --cutoff"; empty where there is no such word, or nothing like it.
[[nodiscard]] std::string meant_option(const CLI::App& verb);

}  // namespace offnominal::desk
