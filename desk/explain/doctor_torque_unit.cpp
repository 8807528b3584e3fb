#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "explain/doctor_checks.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Measured torque over the model's, seen by what only the pose and the other joints ask for.
struct TorqueRatio {
  Index joint = 0;
  double ratio = 1;
};

// None where the model has too little to say of it, or fits it with no factor at all.
std::optional<TorqueRatio> torque_ratio(const TorquePair& pair, Index joint) {
  constexpr double kLeastShare = 0.15;  // of the torque: what the ratio is seen by
  constexpr double kMostLeft = 0.4;     // of that: what no factor explains
  const MatrixXd both = with_model_beside_drive(pair, joint, pair.measured.col(joint));
  const auto measured = both.col(0);
  const auto model = both.col(1);
  const double size = pair.measured.col(joint).norm();
  if (!(model.norm() > 1e-9 * pair.model.col(joint).norm()) || !(size > 0)) return std::nullopt;
  const double ratio = measured.dot(model) / model.squaredNorm();
  const double seen = std::abs(ratio) * model.norm();
  const double left = (measured - ratio * model).norm();
  if (!(seen > kLeastShare * size) || !(left < kMostLeft * measured.norm())) return std::nullopt;
  return TorqueRatio{joint, ratio};
}

// A unit of which an N m (or N) has so many.
struct TorqueUnit {
  double per_si;
  const char* words;
};
constexpr std::array<TorqueUnit, 3> kTorqueUnits = {
    {{1e6, "uN m"}, {1e3, "mN m (N mm)"}, {1e2, "N cm"}}};

// One unit fits all joints that tell; null where none does, as before a gear or of a current.
const TorqueUnit* common_unit(const std::vector<TorqueRatio>& told) {
  constexpr double kNear = 1.35;  // as far off as links of a file are
  const auto* unit =
      std::find_if(kTorqueUnits.begin(), kTorqueUnits.end(), [&](const TorqueUnit& one) {
        return std::all_of(told.begin(), told.end(), [&](const TorqueRatio& of) {
          const double times = std::abs(of.ratio) / one.per_si;
          return times < kNear && times > 1 / kNear;
        });
      });
  return unit == kTorqueUnits.end() ? nullptr : unit;
}

// Whether the torque is so far off the model's on every joint that tells, and to the same side,
// that no link, tool or counterweight does it.
bool is_another_unit(const std::vector<TorqueRatio>& told) {
  // A tool multiplies what a light wrist carries, and a counterweight takes most of it away, each
  // on some joints.
  constexpr double kFarOff = 5;
  constexpr double kFarOffAlone = 50;
  // Above: a heavy tool on light links reaches all of them.
  constexpr double kFarAbove = 15;
  if (told.empty()) return false;
  const auto all = [&](const auto& is_far) {
    return std::all_of(told.begin(), told.end(),
                       [&](const TorqueRatio& one) { return is_far(std::abs(one.ratio)); });
  };
  const bool alone = told.size() == 1;
  const double above = alone ? kFarOffAlone : kFarAbove;
  const double below = alone ? kFarOffAlone : kFarOff;
  return all([&](double ratio) { return ratio > above; }) ||
         all([&](double ratio) { return ratio * below < 1; });
}

std::vector<TorqueRatio> torque_ratios(const TorquePair& pair) {
  std::vector<TorqueRatio> told;
  for (Index joint = 0; joint < pair.measured.cols(); ++joint) {
    if (const auto ratio = torque_ratio(pair, joint)) told.push_back(*ratio);
  }
  return told;
}

}  // namespace

bool is_of_another_torque_unit(const TorquePair& pair) {
  return is_another_unit(torque_ratios(pair));
}

bool find_torque_unit(const Log& log, const TorquePair& pair, std::vector<DataFault>& faults) {
  const std::vector<TorqueRatio> told = torque_ratios(pair);
  if (!is_another_unit(told)) return false;
  const TorqueUnit* unit = common_unit(told);
  std::vector<std::string> ratios;
  for (const TorqueRatio& one : told) {
    ratios.push_back(fmt::format("{:.3g} on joint {}", one.ratio, one.joint + 1));
  }
  DataFault fault;
  fault.kind = DataFaultKind::kTorqueUnit;
  fault.size = told.front().ratio;
  fault.words = fmt::format(
      "the torques are in another unit than the robot file's masses: friction, rotors and offsets "
      "apart, measured over model torque is {}{}",
      fmt::join(ratios, ", "), unit == nullptr ? "" : fmt::format(", as in {}", unit->words));
  if (unit == nullptr) {
    fault.mend =
        "give `torque` its unit under [channels]: `scale` for torques before a gear (its ratio) or "
        "in parts of a rated torque, `motor_current` with the torque_constant of "
        "[transmission] for currents; or the masses of the robot file are those of another arm";
    faults.push_back(std::move(fault));
    return true;
  }
  fault.mend = fmt::format("log N m, or scale the torques by {:g}", 1 / unit->per_si);
  ChannelMap mended = log.channels;
  for (Channel& channel : mended.torque) {
    channel.scale *= std::copysign(1 / unit->per_si, told.front().ratio);
  }
  propose_channels(log, mended, {"torque"}, fault);
  faults.push_back(std::move(fault));
  return true;
}

}  // namespace offnominal::desk
