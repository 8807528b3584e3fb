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

/// The chains that may be meant: from the root to every link that choose_chain() lists as a tip,
/// and from those of them that have joints beyond, to theirs. One at most: the file has no choice.
[[nodiscard]] std::vector<ChainChoice> chains_of(const UrdfDocument& document);

}  // namespace offnominal::desk::exchange
