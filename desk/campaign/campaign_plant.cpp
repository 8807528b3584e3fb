#include "campaign/campaign_plant.hpp"

#include <Eigen/Core>
#include <cmath>
#include <stdexcept>

#include "campaign/read_faults.hpp"
#include "common/error.hpp"
#include "exchange/export_robot.hpp"
#include "sil/robot_plant.hpp"

namespace offnominal::desk::campaign {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kLongestSubstepS = 5e-4;
// Friction that no drive of a robot gets over, N m.
constexpr double kLocksNm = 1e4;

// N m of Coulomb friction that a fault adds; 0: it is of another kind.
double added_friction(const Fault& fault, const RobotDescription& truth) {
  switch (fault.kind) {
    case FaultKind::kFriction:
      return fault.size;
    case FaultKind::kFrictionShare:
      return fault.size * own_friction_nm(truth, fault.joint);
    case FaultKind::kLocked:
      return kLocksNm;
    default:
      return 0;
  }
}

class InMujoco final : public CampaignPlant {
 public:
  InMujoco(const sim::MujocoModel& model, const Campaign& campaign, const sim::JointState& start)
      : campaign_(campaign),
        plant_(model, {.start = start, .longest_substep_s = kLongestSubstepS}) {
    for (const sim::MujocoJoint& joint : model.joints()) losses_.push_back(joint.friction_loss);
  }

  [[nodiscard]] const sim::JointState& state() const override { return plant_.state(); }
  void step(double t_s, const sim::JointVector& given, double period_s) override {
    plant_.step(t_s, given, period_s);
  }
  void begin(const Fault& fault) override {
    const Vector3d place(fault.place_m[0], fault.place_m[1], fault.place_m[2]);
    const double added = added_friction(fault, campaign_.truth);
    if (added > 0) {
      plant_.set_friction_loss(fault.joint, losses_[static_cast<std::size_t>(fault.joint)] + added);
    }
    if (fault.kind == FaultKind::kPayload) plant_.set_payload(fault.joint, fault.size, place);
    if (fault.kind == FaultKind::kPush) {
      const Vector3d direction(fault.direction[0], fault.direction[1], fault.direction[2]);
      plant_.push(fault.joint, fault.size * direction, place);
    }
  }
  void end(const Fault& fault) override {
    if (fault.kind == FaultKind::kPush)
      plant_.push(fault.joint, Vector3d::Zero(), Vector3d::Zero());
  }
  // The semi-implicit Euler method takes each torque at the beginning of a substep.
  [[nodiscard]] double share_of_last_torque() const override {
    const double substeps = std::ceil(campaign_.plant.period_s / kLongestSubstepS - 1e-9);
    return 0.5 * (1 - 1 / substeps);
  }

 private:
  const Campaign& campaign_;
  sim::MujocoPlant plant_;
  std::vector<double> losses_;
};

RobotEffect effect_of(EffectKind kind, int joint, std::vector<double> numbers) {
  RobotEffect effect;
  effect.kind = kind;
  effect.joint = static_cast<std::uint8_t>(joint);
  for (std::size_t i = 0; i < numbers.size(); ++i) effect.parameters[i] = numbers[i];
  return effect;
}

// A fault of the body is another robot from then on, which goes on where the one before it was;
// friction with a memory begins anew.
class OfRobotFile final : public CampaignPlant {
 public:
  OfRobotFile(const Campaign& campaign, const sim::JointState& start)
      : campaign_(campaign), plant_(made({}, start)) {}

  [[nodiscard]] const sim::JointState& state() const override { return plant_->state(); }
  void step(double t_s, const sim::JointVector& given, double period_s) override {
    plant_->step(t_s, given, period_s);
  }
  void begin(const Fault& fault) override {
    constexpr double kSmoothing = 0.01;  // rad/s
    const double added = added_friction(fault, campaign_.truth);
    const sim::JointState now = plant_->state();
    if (added > 0) {
      plant_ =
          made({effect_of(EffectKind::kCoulombFriction, fault.joint, {added, kSmoothing})}, now);
    }
    if (fault.kind == FaultKind::kPayload) {
      const auto& [x, y, z] = fault.place_m;
      plant_ = made({effect_of(EffectKind::kTipPayload, fault.joint, {fault.size, x, y, z})}, now);
    }
  }
  void end(const Fault& /*fault*/) override {}
  // Held over a tick and integrated in second order.
  [[nodiscard]] double share_of_last_torque() const override { return 0.5; }

 private:
  [[nodiscard]] std::unique_ptr<sim::Plant> made(const std::vector<RobotEffect>& hidden,
                                                 const sim::JointState& start) const {
    return sil::make_robot_plant({.robot = campaign_.truth,
                                  .hidden = hidden,
                                  .faults = {},
                                  .start = start,
                                  .period_s = campaign_.plant.period_s});
  }

  const Campaign& campaign_;
  std::unique_ptr<sim::Plant> plant_;
};

}  // namespace

PlantMaker::PlantMaker(const Campaign& campaign) : campaign_(campaign) {
  if (campaign.plant.kind != PlantKind::kMujoco) return;
  try {
    mujoco_ = sim::MujocoModel::from_text(exchange::export_mjcf(campaign.truth, "").text);
  } catch (const std::runtime_error& error) {
    throw InputError({.file = campaign.file,
                      .place = "plant",
                      .found = error.what(),
                      .allowed = "a robot file of which MuJoCo takes what export-mjcf writes",
                      .mend = "take kind = \"robot\""});
  }
}

std::unique_ptr<CampaignPlant> PlantMaker::make(const sim::JointState& start) const {
  if (mujoco_) return std::make_unique<InMujoco>(*mujoco_, campaign_, start);
  return std::make_unique<OfRobotFile>(campaign_, start);
}

}  // namespace offnominal::desk::campaign
