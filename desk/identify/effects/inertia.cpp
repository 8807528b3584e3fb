#include <algorithm>
#include <cmath>

#include "identify/effects/effects.hpp"
#include "identify/nuisance.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;

// On the last link, anywhere about its centre of mass where the arm has three joints or more: the
// weight that fewer feel at another place is a constant torque or a spring beside the one along x.
class TipPayload final : public EffectCandidate {
 public:
  TipPayload() : EffectCandidate(EffectKind::kTipPayload) {}
  std::vector<ShapeRange> shapes(const std::vector<Workspace>& at, Index joint) const override {
    constexpr Index kAnywhere = 3;
    const RobotDescription& robot = at[0].rigid;
    const auto last = static_cast<std::size_t>(joint);
    const auto& centre = robot.joints[last].joint.centre_of_mass_m;
    std::vector<ShapeRange> place;
    for (std::size_t axis = 0; axis < centre.size(); ++axis) {
      place.push_back(range_of(kX + axis, at[0].joint_type(joint)));
    }
    if (at[0].joint_count() < kAnywhere) {
      place[0].grid = {1.5 * centre[0], 1.75 * centre[0], 2 * centre[0], 2.5 * centre[0],
                       3 * centre[0]};
      std::sort(place[0].grid.begin(), place[0].grid.end());  // a link may point backwards
      place[1].grid = {0};
      place[2].grid = {0};
      return place;
    }
    const double away = farthest(robot, last);
    for (std::size_t axis = 0; axis < centre.size(); ++axis) {
      place[axis].grid = {centre[axis] - away, centre[axis], centre[axis] + away};
    }
    return place;
  }
  bool applies(const Workspace& at, Index joint) const override {
    return joint + 1 == at.joint_count();
  }
  bool acts_at_rest(const Workspace& at, Index joint) const override { return applies(at, joint); }

 protected:
  bool finds(const ParameterInfo& /*parameter*/) const override { return true; }

 private:
  static constexpr std::size_t kX = 1;

  // How far from the last link's centre of mass a payload may be, m: twice the link's size, or a
  // fifth of what the arm reaches.
  static double farthest(const RobotDescription& robot, std::size_t last) {
    double reach = 0;
    for (const RobotJoint& one : robot.joints) {
      reach += std::hypot(one.joint.origin_m[0], one.joint.origin_m[1], one.joint.origin_m[2]);
    }
    const auto& centre = robot.joints[last].joint.centre_of_mass_m;
    reach += std::hypot(centre[0], centre[1], centre[2]);
    return std::max(2 * size_of_link(robot, last), 0.2 * reach);
  }
};

}  // namespace

Candidate payload_candidate(EffectKind kind) {
  if (kind == EffectKind::kTipPayload) return std::make_unique<TipPayload>();
  return nullptr;
}

}  // namespace offnominal::desk
