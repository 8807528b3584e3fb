#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"
#include "explain/other_masses.hpp"

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
  constexpr double kLeastSeen = 0.15;  // of the torque: what the ratio is seen by
  constexpr double kMostLeft = 0.4;    // of that: what no factor explains
  const VectorXd measured = beside_drive(pair, joint, pair.measured.col(joint));
  const VectorXd model = beside_drive(pair, joint, pair.model.col(joint));
  const double size = pair.measured.col(joint).norm();
  if (!(model.norm() > 1e-9 * pair.model.col(joint).norm()) || !(size > 0)) return std::nullopt;
  const double ratio = measured.dot(model) / model.squaredNorm();
  const double seen = std::abs(ratio) * model.norm();
  const double left = (measured - ratio * model).norm();
  if (!(seen > kLeastSeen * size) || !(left < kMostLeft * measured.norm())) return std::nullopt;
  return TorqueRatio{joint, ratio};
}

// How many times the model a torque is where it may be the tool, a counterweight, or links that
// the file has wrong; beyond, it is none of them.
constexpr double kFarOff = 5;
// Where no other joint can tell.
constexpr double kFarOffAlone = 50;

// A unit of which an N m (or N) has so many.
struct TorqueUnit {
  double per_si;
  const char* words;
};
constexpr std::array<TorqueUnit, 3> kTorqueUnits = {
    {{1e6, "uN m"}, {1e3, "mN m (N mm)"}, {1e2, "N cm"}}};

// One unit fits all of these joints; null where none does, as before a gear or of a current.
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

// What a joint before it feels at least, as a share of what is felt at `joint`, where a link behind
// both is heavier or has its mass elsewhere. 0: nothing, as of gravity about a vertical axis.
double felt_before(const TorquePair& pair, Index joint, Index before) {
  constexpr double kMatters = 0.1;  // of what the heaviest link takes
  std::vector<std::pair<double, double>> here_and_before;
  double largest = 0;
  for (Index link = joint; link < pair.measured.cols(); ++link) {
    const Eigen::MatrixXd& share = pair.links[static_cast<std::size_t>(link)];
    const double here = beside_drive(pair, joint, share.col(joint)).norm();
    here_and_before.emplace_back(here, beside_drive(pair, before, share.col(before)).norm());
    largest = std::max(largest, here);
  }
  // A mass moved on its link is felt about as much on either side of it.
  double least = 1;
  for (const auto& [here, further] : here_and_before) {
    if (here > kMatters * largest) least = std::min(least, further / here);
  }
  return largest > 0 ? least : 0;
}

// The joint before that would feel most of what masses would have to be to ask for this torque, and
// whether it does.
struct Witness {
  Index joint = -1;  // none can tell
  bool denies = false;
};
Witness witness_of(const TorquePair& pair, const TorqueRatio& far) {
  constexpr double kFeels = 0.2;
  constexpr double kDenies = 0.3;  // of what it would feel: what it lacks
  const double lacks =
      (std::abs(far.ratio) - 1) * beside_drive(pair, far.joint, pair.model.col(far.joint)).norm();
  Witness best;
  double least = kDenies;
  for (Index before = 0; before < far.joint; ++before) {
    const double felt = felt_before(pair, far.joint, before);
    if (!(felt > kFeels)) continue;
    if (best.joint < 0) best.joint = before;
    const VectorXd left = pair.measured.col(before) - pair.model.col(before);
    const double share = beside_drive(pair, before, left).norm() / (felt * lacks);
    if (!(share < least)) continue;
    least = share;
    best = {before, true};
  }
  return best;
}

// Whether a heavy tool or other links say as much of all torques, this one's as it is, as another
// unit of it does, whatever the masses are then.
bool is_by_masses(const RobotDescription& robot, const TorquePair& pair, const TorqueRatio& far) {
  constexpr double kNoise = 0.1;
  const TorquePair rows = thinned(pair);
  const auto left = [&](double ratio) {
    std::vector<double> sizes = sizes_about_mean(rows.measured);
    sizes[static_cast<std::size_t>(far.joint)] /= std::abs(ratio);
    MatrixXd error = rows.measured - rows.model;
    error.col(far.joint) = rows.measured.col(far.joint) / ratio - rows.model.col(far.joint);
    return OtherMasses(robot, rows, std::move(sizes), kNoise).left_of_each(error).norm();
  };
  return left(1) <= left(far.ratio);
}

// Of some joints alone: a small drive that logs another unit than the large ones.
struct JointOfAnotherUnit {
  TorqueRatio told;
  Witness witness;
};
std::vector<JointOfAnotherUnit> joints_of_another_unit(const RobotDescription& robot,
                                                       const TorquePair& pair,
                                                       const std::vector<TorqueRatio>& told) {
  std::vector<JointOfAnotherUnit> found;
  for (const TorqueRatio& one : told) {
    const double ratio = std::abs(one.ratio);
    const Witness witness = ratio > 1 ? witness_of(pair, one) : Witness{};
    const bool far = witness.joint < 0 ? ratio > kFarOffAlone || ratio * kFarOffAlone < 1
                                       : ratio > kFarOff && witness.denies;
    if (far && !is_by_masses(robot, pair, one)) found.push_back({one, witness});
  }
  // The scale of the others is what theirs is held against.
  if (found.size() == told.size()) found.clear();
  return found;
}

// Every joint with its own factor, where no unit is known for it.
constexpr const char* kScaleItself =
    "under [channels]: `scale` for torques before a gear (its ratio) or "
    "in parts of a rated torque, `motor_current` with the torque_constant of "
    "[transmission] for currents";

void add_fault_of_all(const Log& log, const std::vector<TorqueRatio>& told,
                      std::vector<DataFault>& faults) {
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
    fault.mend = fmt::format(
        "give `torque` its unit {}; or the masses of the robot file are those of another arm",
        kScaleItself);
    faults.push_back(std::move(fault));
    return;
  }
  fault.mend = fmt::format("log N m, or scale the torques by {:g}", 1 / unit->per_si);
  ChannelMap mended = log.channels;
  for (Channel& channel : mended.torque) {
    channel.scale *= std::copysign(1 / unit->per_si, told.front().ratio);
  }
  propose_channels(log, mended, {"torque"}, fault);
  faults.push_back(std::move(fault));
}

void add_faults_of_joints(const Log& log, const std::vector<JointOfAnotherUnit>& found,
                          std::vector<DataFault>& faults) {
  ChannelMap mended = log.channels;
  bool all_mended = true;
  for (const auto& [told, witness] : found) {
    const TorqueUnit* unit = common_unit({told});
    const auto index = static_cast<std::size_t>(told.joint);
    all_mended = all_mended && unit != nullptr && index < mended.torque.size();
    if (all_mended) {
      mended.torque[index].scale *= std::copysign(1 / unit->per_si, told.ratio);
    }
  }
  for (const auto& [told, witness] : found) {
    const TorqueUnit* unit = common_unit({told});
    DataFault fault;
    fault.kind = DataFaultKind::kTorqueUnit;
    fault.joint = told.joint;
    fault.size = told.ratio;
    fault.words = fmt::format(
        "the torque of joint {} is in another unit than the others: friction, rotor and offset "
        "apart, measured over model torque is {:.3g}{}{}",
        told.joint + 1, told.ratio, unit == nullptr ? "" : fmt::format(", as in {}", unit->words),
        witness.joint < 0
            ? ""
            : fmt::format("; a mass that asks for it would be felt at joint {} too, and is not",
                          witness.joint + 1));
    fault.mend = unit == nullptr ? fmt::format("give the torque of joint {} its unit {}",
                                               told.joint + 1, kScaleItself)
                                 : fmt::format("log N m, or scale the torque of joint {} by {:g}",
                                               told.joint + 1, 1 / unit->per_si);
    if (all_mended) propose_channels(log, mended, {"torque"}, fault);
    faults.push_back(std::move(fault));
  }
}

}  // namespace

bool is_of_another_torque_unit(const TorquePair& pair) {
  return is_another_unit(torque_ratios(pair));
}

OfAnotherUnit find_torque_unit(const Log& log, const RobotDescription& robot,
                               const TorquePair& pair, std::vector<DataFault>& faults) {
  const std::vector<TorqueRatio> told = torque_ratios(pair);
  if (is_another_unit(told)) {
    add_fault_of_all(log, told, faults);
    return OfAnotherUnit::kAllJoints;
  }
  std::vector<JointOfAnotherUnit> found = joints_of_another_unit(robot, pair, told);
  // One torque at rest is another mass, or an offset.
  const std::vector<char> held = held_joints(pair.q, robot);
  std::erase_if(found, [&](const JointOfAnotherUnit& one) {
    return held[static_cast<std::size_t>(one.told.joint)] != 0;
  });
  add_faults_of_joints(log, found, faults);
  return found.empty() ? OfAnotherUnit::kNone : OfAnotherUnit::kSomeJoints;
}

}  // namespace offnominal::desk
