#pragma once

#include <memory>
#include <optional>

#include "campaign/campaign.hpp"
#include "offnominal/sim/plant.hpp"
#include "offnominal/sim/plants/mujoco_plant.hpp"

namespace offnominal::desk::campaign {

/// The plant of one run, with a fault that comes and may go. What a drive or an encoder does wrong
/// is not its part.
class CampaignPlant {
 public:
  virtual ~CampaignPlant() = default;

  [[nodiscard]] virtual const sim::JointState& state() const = 0;
  /// As sim::Plant::step().
  virtual void step(double t_s, const sim::JointVector& given, double period_s) = 0;
  /// From now on: payload, friction, friction_share, locked, push; no effect of others.
  virtual void begin(const Fault& fault) = 0;
  /// The push is over; no effect of others.
  virtual void end(const Fault& fault) = 0;
  /// What acts at a tick's time, in the mean: so much of the torque of the tick before it.
  [[nodiscard]] virtual double share_of_last_torque() const = 0;
};

/// Makes plants of one campaign; may be used by several threads at once.
class PlantMaker {
 public:
  /// Throws InputError where MuJoCo refuses what the robot file says.
  explicit PlantMaker(const Campaign& campaign);

  /// At rest or on the move, as `start` says. Throws InputError as sil::make_robot_plant().
  [[nodiscard]] std::unique_ptr<CampaignPlant> make(const sim::JointState& start) const;

 private:
  const Campaign& campaign_;
  std::optional<sim::MujocoModel> mujoco_;
};

}  // namespace offnominal::desk::campaign
