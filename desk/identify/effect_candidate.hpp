#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "compare/inverse_model.hpp"
#include "identify/workspace.hpp"

namespace offnominal::desk {

// Torque of one joint over a recording, at its full rate, that a coefficient of 1 contributes.
struct JointTorque {
  Eigen::Index joint = 0;
  Eigen::VectorXd values;
};
// One linear coefficient's torques, on every joint that it acts on.
using Regressor = std::vector<JointTorque>;

// One value of each shape parameter of a candidate, in the order of EffectCandidate::shapes().
using ShapePoint = std::vector<double>;

// A shape parameter and where it is looked for.
struct ShapeRange {
  std::string name;
  std::string unit;
  std::vector<double> grid;  // ascending; a single value is given, not looked for
  enum class Kind {
    kLinear,       // refined between the grid's values
    kLogarithmic,  // the same, in its logarithm
    kDiscrete      // only the grid's values have a meaning
  } kind = Kind::kLinear;
  // At which end another effect is meant.
  OtherEffectAt other_effect = OtherEffectAt::kNeitherEnd;

  // Whether a searched value lies at that end.
  [[nodiscard]] bool is_other_effect(double value) const;
  // Whether the best value lies anywhere between the grid's ends and has to be looked for.
  [[nodiscard]] bool is_searched() const { return kind != Kind::kDiscrete && grid.size() >= 2; }
  // Whether it has no meaning below zero: a width, a velocity or a time constant.
  [[nodiscard]] bool is_positive() const { return kind == Kind::kLogarithmic; }
};

// Every combination of the ranges' grid values; one empty point where there are no ranges.
std::vector<ShapePoint> product_grid(const std::vector<ShapeRange>& ranges);

struct NamedValue {
  std::string name;
  double value = 0;
  std::string unit;
};

// An effect's own torque over a recording, of what acts by itself and not on the whole drive.
Regressor torque_of(const Workspace& at, const Effect<double>& effect);

// A physical effect that may be missing from a model, on one joint: core's struct of it as a search
// sees it. Regressors follow the sign of offnominal/model/effect.hpp: what the drive has to supply.
// An effect whose mathematics in a search is not the struct's own has a class in effects/.
class EffectCandidate {
 public:
  using Parameters = std::array<double, kMaxEffectParameters>;

  // Of an effect that info_of() knows.
  explicit EffectCandidate(EffectKind kind) : info_(*info_of(kind)) {}
  virtual ~EffectCandidate() = default;
  EffectCandidate(const EffectCandidate&) = delete;
  EffectCandidate& operator=(const EffectCandidate&) = delete;

  [[nodiscard]] const EffectInfo& info() const { return info_; }
  [[nodiscard]] EffectKind kind() const { return info_.kind; }
  [[nodiscard]] const char* name() const { return info_.name; }

  // Shape parameters with grids that suit the recordings: by default those that the struct says a
  // share for, and the other joint.
  [[nodiscard]] virtual std::vector<ShapeRange> shapes(const std::vector<Workspace>& at,
                                                       Eigen::Index joint) const;
  // By default one per linear parameter: the struct's own torque with that one 1 and the others 0.
  [[nodiscard]] virtual std::vector<Regressor> regressors(const Workspace& at, Eigen::Index joint,
                                                          std::span<const double> shape) const;
  // The struct's parameters, those that the search finds set: by default the coefficients and the
  // shape, in the struct's order.
  [[nodiscard]] virtual Parameters found_parameters(const Eigen::VectorXd& coefficients,
                                                    std::span<const double> shape) const;
  // Whether fitted coefficients are physical: friction takes energy out, and an operator whose size
  // is in its shape has a coefficient near 1. By default what the struct says of their sign.
  [[nodiscard]] virtual bool is_physical(const Eigen::VectorXd& coefficients) const;
  // Whether these recordings can show the effect as it came out: by default, where no number of its
  // shape lies at an end of its range at which another effect is meant. `ranges`: of the shape.
  [[nodiscard]] virtual bool is_within_reach(const std::vector<Workspace>& at, Eigen::Index joint,
                                             const Eigen::VectorXd& coefficients,
                                             std::span<const double> shape,
                                             const std::vector<ShapeRange>& ranges) const;
  // Whether the effect can act on this joint of the robot.
  [[nodiscard]] virtual bool applies(const Workspace& at, Eigen::Index joint) const;
  // ... as any of the recordings has it: a joint may stand in the first.
  [[nodiscard]] bool applies_in_any(const std::vector<Workspace>& at, Eigen::Index joint) const;
  // Whether it acts on this joint where nothing moves: what hold maps are searched for. By default
  // what the struct says, unless it counts time, which readings at rest do not have.
  [[nodiscard]] virtual bool acts_at_rest(const Workspace& at, Eigen::Index joint) const;
  // Decided by forward simulation: regression only screens it.
  [[nodiscard]] virtual bool is_only_screened() const { return false; }

  // Takes the place of the nuisance time skew (nuisance.hpp) once it is in the model. Its only
  // coefficient is a time then, and no discovery within what the skew may be.
  [[nodiscard]] bool replaces_skew() const { return info_.action == EffectAction::kDelay; }
  // A mass at a place, which every joint that carries it feels.
  [[nodiscard]] bool is_mass() const { return info_.action == EffectAction::kPointMass; }
  // A transmission that gives way under torque.
  [[nodiscard]] bool gives_way() const { return info_.action == EffectAction::kDisplacement; }
  // Scales all that the drive of a joint gives.
  [[nodiscard]] bool is_torque_constant() const {
    return info_.action == EffectAction::kToldPerGiven;
  }
  // The grid is a spectrum: it is screened by a periodogram over this variable.
  enum class Spectrum { kNone, kPosition, kTime };
  [[nodiscard]] Spectrum spectrum() const;

  // Whether a shape parameter of the struct comes out of the coefficients here.
  [[nodiscard]] virtual bool shape_is_coefficient(std::size_t /*parameter*/) const { return false; }
  // A value for a parameter that the search does not find, instead of the struct's default.
  void give(std::size_t parameter, double value) { given_[parameter] = value; }

  // Makes it the effect of a motor that moves these joints, instead of a joint's: `joint` is then
  // the motor's number everywhere, and motor_may_be_searched().
  void act_on_motor(std::vector<MovedJoint> moved) { moved_ = std::move(moved); }
  [[nodiscard]] bool of_motor() const { return !moved_.empty(); }

  // What the user reads: the parameters that the search finds.
  [[nodiscard]] std::vector<NamedValue> parameters(JointType type,
                                                   const Eigen::VectorXd& coefficients,
                                                   std::span<const double> shape) const;
  // As core has it. What the search does not find is the struct's default, and the width of the
  // smoothed sign is that of the joint whose velocity the effect follows, of `sign_width`.
  [[nodiscard]] Effect<double> effect(Eigen::Index joint, const Eigen::VectorXd& coefficients,
                                      std::span<const double> shape,
                                      const Eigen::VectorXd& sign_width) const;

 protected:
  // Whether the search finds this parameter of the struct: by default one that has no default, and
  // one that the struct says a share for.
  [[nodiscard]] virtual bool finds(const ParameterInfo& parameter) const;
  [[nodiscard]] Eigen::Index linear_count() const;
  // The range of that parameter of the struct, which every class may fill in its own way.
  [[nodiscard]] ShapeRange range_of(std::size_t parameter, JointType type) const;
  // What remains of an operator's coefficient where the operator itself is the effect.
  [[nodiscard]] static bool is_near_one(double share) { return share > 0.6 && share < 1.5; }

 private:
  // Of a speed, way or width that every joint has, that of the place: of a motor the most that its
  // joints make of it.
  [[nodiscard]] double at_place(const Eigen::VectorXd& of_joints, Eigen::Index joint) const;

  const EffectInfo& info_;
  std::vector<MovedJoint> moved_;
  std::array<std::optional<double>, kMaxEffectParameters> given_{};
};

using Candidate = std::unique_ptr<EffectCandidate>;

// Whether a search can look for the effect on a motor's shaft: what a file's motor may have,
// without a class in effects/ that asks for the joint's motion.
bool motor_may_be_searched(EffectKind kind);

// An effect as a search sees it, with the class that it has in effects/.
Candidate candidate_of(EffectKind kind);

// Every effect that the analysis knows, in core's order.
const std::vector<std::unique_ptr<const EffectCandidate>>& all_candidates();

}  // namespace offnominal::desk
