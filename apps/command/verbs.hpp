#pragma once

#include <span>

namespace CLI {
class App;
}

namespace offnominal::desk {

enum class ExitCode : int {
  kDone = 0,
  kCheckFailed = 1,  // the verb ran, and a check that the user asked for failed
  kBadInput = 2,     // nothing was done; one line on stderr says why
};

/// Gives a verb its options, its help and the callback that runs it. The callback sets `exit_code`
/// when it ends in something other than kDone and throws InputError on a bad input.
using SetUpVerb = void(CLI::App& verb, ExitCode& exit_code);

/// A verb of the command: the file verb_<name>.cpp, which defines set_up_<name>(), its declaration
/// below, and a row of the table in verbs.cpp. Dispatch, help and suggestions follow from it.
struct Verb {
  const char* name;
  const char* words;  // what it does, one line of help
  SetUpVerb* set_up;
};

[[nodiscard]] std::span<const Verb> all_verbs();

SetUpVerb set_up_add, set_up_calibrate, set_up_campaign, set_up_codegen, set_up_compare,
    set_up_explain, set_up_export_mjcf, set_up_export_urdf, set_up_identify, set_up_import_urdf,
    set_up_look, set_up_motion, set_up_new, set_up_paper, set_up_replay, set_up_sil, set_up_studio,
    set_up_tune;

}  // namespace offnominal::desk
