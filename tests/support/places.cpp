#include "support/places.hpp"

namespace offnominal::test {

std::filesystem::path source_dir() { return OFFNOMINAL_SOURCE_DIR; }

#ifdef OFFNOMINAL_COMMAND
std::string command_file() { return OFFNOMINAL_COMMAND; }
#endif

#ifdef OFFNOMINAL_CONTROLLER
std::string controller_file() { return OFFNOMINAL_CONTROLLER; }
#endif

#ifdef OFFNOMINAL_WCET
std::string wcet_file() { return OFFNOMINAL_WCET; }
#endif

}  // namespace offnominal::test
