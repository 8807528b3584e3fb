#pragma once

#include <string>
#include <vector>

namespace offnominal::tools {

bool same_file(const std::string& a, const std::string& b);

// Throws InputError, in the name of `verb` ("add") and the option that names the file ("-o"), when
// `output` is one of the recordings, or is there already and `force` does not allow to replace it.
void check_output_file(const std::string& verb, const std::string& option,
                       const std::string& output, bool force,
                       const std::vector<std::string>& recordings = {});

}  // namespace offnominal::tools
