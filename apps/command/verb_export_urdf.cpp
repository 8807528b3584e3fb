#include "command/export_verb.hpp"
#include "command/verbs.hpp"

namespace offnominal::desk {

void set_up_export_urdf(CLI::App& verb, ExitCode& /*exit_code*/) {
  set_up_export(verb, {"URDF", exchange::export_urdf});
}

}  // namespace offnominal::desk
