// A robot of MuJoCo as a plant: its dynamics share no formula with the core's.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "offnominal/sim/bus/fault_event.hpp"
#include "offnominal/sim/plant.hpp"

namespace offnominal::sim {

/// A joint of the model with the link that it moves, from the base outwards.
struct MujocoJoint {
  std::string name;
  bool turns = true;         // else it slides
  double friction_loss = 0;  // N m or N
  double damping = 0;        // N m s/rad or N s/m
  double armature = 0;       // kg m^2 or kg
};

/// What MuJoCo makes of an MJCF or a URDF. Its actuators are not used: drives are the plant's.
/// Copies share the model.
class MujocoModel {
 public:
  /// Throws std::runtime_error with MuJoCo's own words where it cannot read them, and for a model
  /// that has no joint, more than kMaxJoints, or others than those that turn about or slide along
  /// one axis.
  [[nodiscard]] static MujocoModel from_text(const std::string& text);
  [[nodiscard]] static MujocoModel from_file(const std::filesystem::path& file);

  [[nodiscard]] const std::vector<MujocoJoint>& joints() const { return joints_; }

 private:
  friend class MujocoPlant;
  struct Handle;
  explicit MujocoModel(std::shared_ptr<const Handle> handle);
  std::shared_ptr<const Handle> handle_;
  std::vector<MujocoJoint> joints_;
};

enum class MujocoIntegrator { kEuler, kRungeKutta4 };

struct MujocoSetup {
  JointState start;
  /// mass_loss, payload and friction_jump act here; others have no effect. A payload hangs at the
  /// last link's centre of mass.
  std::vector<FaultEvent> faults = {};
  /// A step of the plant is divided into as many as keep each at most this long, s.
  double longest_substep_s = 5e-4;
  /// Semi-implicit, one evaluation a substep, the damping implicit; or explicit, four of them.
  MujocoIntegrator integrator = MujocoIntegrator::kEuler;
};

/// Friction loss is solved for as a constraint that holds a joint at rest: stiffer than MuJoCo's
/// default, as stiff as the substep allows. Limits of position and contacts are those of the file.
/// What the setters change stays until they are called again.
class MujocoPlant final : public Plant {
 public:
  /// Throws std::invalid_argument where the start has another number of joints than the model, or a
  /// fault a joint that it has not.
  MujocoPlant(const MujocoModel& model, const MujocoSetup& setup);
  ~MujocoPlant() override;
  MujocoPlant(const MujocoPlant&) = delete;
  MujocoPlant& operator=(const MujocoPlant&) = delete;

  [[nodiscard]] const JointState& state() const override { return state_; }
  void step(double t_s, const JointVector& tau, double period_s) override;
  /// Of the faults that it was last given.
  [[nodiscard]] JointVector fault_function(double t_s, const JointVector& tau) const override;
  /// True. Throws std::invalid_argument for a joint that the model has not, and changes nothing.
  [[nodiscard]] bool set_faults(const std::vector<FaultEvent>& faults) override;

  /// N m or N, >= 0.
  void set_friction_loss(Eigen::Index joint, double level);
  /// N m s/rad or N s/m.
  void set_damping(Eigen::Index joint, double coefficient);
  /// A point mass, kg, on the link behind a joint, at a place in its body's frame, m, in place of
  /// the one before; 0 takes it off. The joints keep their velocity.
  void set_payload(Eigen::Index joint, double mass_kg, const Eigen::Vector3d& at_m);
  /// A force, N in the world's frame, on the link behind a joint, at a place in its body's frame.
  void push(Eigen::Index joint, const Eigen::Vector3d& force_n, const Eigen::Vector3d& at_m);

  /// What the drives have to give for this motion, N m or N, with everything that the model has
  /// but friction loss and limits. The plant stays where it is.
  [[nodiscard]] JointVector inverse_dynamics(const DesiredMotion& motion) const;
  /// What passed from drive to link over the last substep, N m or N: the drive's torque less
  /// friction, damping and what turned the rotor.
  [[nodiscard]] const JointVector& gear_torque() const { return gear_torque_; }
  /// Of motion and of weight, J.
  [[nodiscard]] double energy_j() const;

 private:
  struct Simulation;
  void take_faults(const std::vector<FaultEvent>& faults);
  std::unique_ptr<Simulation> simulation_;
  std::vector<FaultEvent> faults_;
  double longest_substep_s_;
  JointState state_;
  JointVector gear_torque_;
};

}  // namespace offnominal::sim
