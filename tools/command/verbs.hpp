#pragma once

#include <vector>

namespace CLI {
class App;
}

namespace offnominal::tools {

enum class ExitCode : int {
  kDone = 0,
  kCheckFailed = 1,  // the verb ran, and a check that the user asked for failed
  kBadInput = 2,     // nothing was done; one line on stderr says why
};

/// Adds one verb to `app`: its name, options, help and the callback that runs it. The callback sets
/// `exit_code` when it ends in something other than kDone and throws InputError on a bad input.
using RegisterVerb = void (*)(CLI::App& app, ExitCode& exit_code);

void register_add(CLI::App& app, ExitCode& exit_code);
void register_calibrate(CLI::App& app, ExitCode& exit_code);
void register_codegen(CLI::App& app, ExitCode& exit_code);
void register_compare(CLI::App& app, ExitCode& exit_code);
void register_explain(CLI::App& app, ExitCode& exit_code);
void register_motion(CLI::App& app, ExitCode& exit_code);
void register_paper(CLI::App& app, ExitCode& exit_code);
void register_replay(CLI::App& app, ExitCode& exit_code);
void register_sil(CLI::App& app, ExitCode& exit_code);
void register_wcet(CLI::App& app, ExitCode& exit_code);

/// Every verb that this build has.
[[nodiscard]] const std::vector<RegisterVerb>& all_verbs();

}  // namespace offnominal::tools
