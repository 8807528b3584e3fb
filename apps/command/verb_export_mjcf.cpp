#include "command/export_verb.hpp"
#include "command/verbs.hpp"

namespace offnominal::desk {

void set_up_export_mjcf(CLI::App& verb, ExitCode& /*exit_code*/) {
  set_up_export(verb, {"MJCF", exchange::export_mjcf});
}

}  // namespace offnominal::desk
