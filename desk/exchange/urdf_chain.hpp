#pragma once

#include <vector>

#include "exchange/chain_request.hpp"
#include "exchange/urdf_document.hpp"

namespace offnominal::desk::exchange {

/// A serial chain of a URDF's tree.
struct UrdfChain {
  urdf::LinkConstSharedPtr base;
  urdf::LinkConstSharedPtr tip;
  std::vector<urdf::JointConstSharedPtr> moving;  // from the base outwards: all but the fixed ones
};

/// Throws InputError where a link is none of the file's, the tip is not beyond the base, nothing
/// moves between them, or more than kMaxJoints do; and, with the tips that there are, where no tip
/// is given and there are several.
[[nodiscard]] UrdfChain choose_chain(const UrdfDocument& document, const ChainRequest& request);

}  // namespace offnominal::desk::exchange
