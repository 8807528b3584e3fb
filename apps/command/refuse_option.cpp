#include "command/refuse_option.hpp"

#include "common/error.hpp"

namespace offnominal::desk {

void refuse_option(const std::string& verb, const std::string& option, const std::string& found,
                   const std::string& allowed, const std::string& mend) {
  throw InputError({"offnominal " + verb, option, found, allowed, mend});
}

}  // namespace offnominal::desk
