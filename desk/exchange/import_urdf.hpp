#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/chain_request.hpp"
#include "robot/robot.hpp"

// A serial chain of a URDF as a robot file. What stands in it and what had to be merged, held, left
// out or assumed on the way is said, each with its line: nothing is guessed silently.

namespace offnominal::desk::exchange {

struct ImportNote {
  enum class Kind : std::uint8_t {
    kMerged,   // a link that is fixed to a link of the chain, and is part of it now
    kHeld,     // a joint that moves, but not in the chain: it stands still at a position
    kLeftOut,  // what a robot file does not hold
    kAssumed,  // what the URDF does not say
  };
  Kind kind = Kind::kAssumed;
  int line = 0;  // 0: of no line
  std::string text;
};

[[nodiscard]] const char* name_of(
    ImportNote::Kind kind);  // "merged", "held", "left out", "assumed"

// What becomes of a link's inertia that no body has.
enum class InertiaRule : std::uint8_t {
  kPossible,  // refused, unless a tenth of its largest principal moment is enough to mend it
  kNearest,   // the nearest one that a body can have
};

struct ImportedRobot {
  RobotDescription robot;
  std::string base;  // links
  std::string tip;
  std::vector<std::string> links;  // per joint: the link that moves with it
  std::vector<ImportNote> notes;   // by kind, then by line
  ChainRequest request = {};       // that it was chosen by
};

/// Links that are fixed to a link of the chain are merged into it, what hangs on other joints is
/// held at 0, or at the nearest position that its limits allow; inertias are turned into the link's
/// frame and moved to the common centre of mass. <dynamics> become viscous and Coulomb friction.
/// Limits of 0 count as not known. Gravity is 9.81 m/s^2 along -z of the root. The base does not
/// move: its mass, and what stands between it and the root, are left out.
///
/// Throws InputError with line and remedy where parse_urdf() and choose_chain() do; on a mimic,
/// floating or planar joint in the chain, an axis of no length, a range without width; a link of
/// the chain that has no mass; and an inertia that no body has, as `inertia` says.
[[nodiscard]] ImportedRobot import_urdf(std::string_view text, const std::string& file,
                                        const ChainRequest& request = {},
                                        InertiaRule inertia = InertiaRule::kPossible);

/// The chains that `request` may ask for; one at most: it need not. Throws InputError where
/// parse_urdf() does.
[[nodiscard]] std::vector<ChainChoice> chains_in(std::string_view text, const std::string& file);

}  // namespace offnominal::desk::exchange
