#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "compare/before_after.hpp"
#include "compare/compare.hpp"
#include "identify/freedom.hpp"
#include "identify/inertial_regressor.hpp"
#include "identify/on_progress.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

struct IdentifyRequest {
  // Nothing of the file but its geometry is believed; so too of links with blanks.
  bool from_geometry = false;
  bool payload = false;  // the last link alone, against a file that is trusted
  bool keep = false;     // effects of the file stay as they are
  std::string source;    // what is written of where the numbers come from
};

// One number: in the file, as it was identified, and whether the recordings determine it: they tell
// it five times as sharply as the geometry alone does.
struct IdentifiedNumber {
  std::string name;
  std::string unit;
  double before = std::numeric_limits<double>::quiet_NaN();  // NaN: the file has none
  double after = 0;
  std::optional<Interval> ci95 = {};
  std::string why_no_interval = {};
  bool determined = false;
};

struct IdentifiedLink {
  std::size_t link = 0;
  IdentifiedNumber mass;
  std::array<IdentifiedNumber, 3> centre;  // of mass, in the link's frame
};

struct IdentifiedDrive {
  std::size_t joint = 0;
  EffectKind kind = EffectKind::kViscousFriction;
  IdentifiedNumber number;
  bool written = true;  // false: it came out as nothing, and the file has none
};

// What the last link carries more than the file says, as a body.
struct IdentifiedPayload {
  IdentifiedNumber mass;
  std::array<IdentifiedNumber, 3> place;  // of its centre of mass, in the last link's frame
};

struct Identification {
  RobotDescription robot;
  std::vector<IdentifiedLink> links;
  std::vector<IdentifiedDrive> drives;
  std::vector<IdentifiedNumber> base;  // base parameters: what torques depend on
  std::optional<IdentifiedPayload> payload;
  double condition =
      0;  // of the weighted regressor of base parameters and drives, columns of length 1
  // How far the links were believed, as a share: chosen by the error on held-out parts.
  double share = 0;
  std::vector<std::size_t> standing;  // joints that do not move
  std::vector<BeforeAfter> fitted;    // per joint; before is NaN where the file has no links
  std::vector<BeforeAfter> held_out;
  bool cross_validated = false;      // held_out is from parts of the fitted recordings
  std::optional<Comparison> before;  // on the first held-out recording, or the first fitted one
  Comparison after;
  std::vector<std::string> notes;
  std::vector<std::string> objections;  // why the result must not be used
  std::vector<std::string> doubts;      // why it should not be; the user may overrule them

  [[nodiscard]] bool may_be_written(bool overruled) const {
    return objections.empty() && (doubts.empty() || overruled);
  }
  [[nodiscard]] std::size_t determined_count() const;
};

// Whether the file has numbers of a link.
[[nodiscard]] bool has_numbers(const RobotDescription& file, std::size_t link);

// Mass, centre and inertia of every link, each a body that there can be, and the standard drive of
// every joint (viscous and Coulomb friction, rotor inertia, offset), fitted to recordings in time.
// The recordings decide what torques depend on, the file or the geometry the rest. Throws
// InputError as plan_filter().
Identification identify(const RobotDescription& robot, const IdentifyRequest& request,
                        const std::vector<Log>& logs, const std::vector<Log>& holdout,
                        const FilterRequest& filter = {}, const OnProgress& on_progress = {});

}  // namespace offnominal::desk
