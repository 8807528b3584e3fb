#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "discovery/workspace.hpp"

namespace offnominal::tools::discovery {

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

// A linear parameter as the user reads it.
struct LinearParameter {
  std::string name;
  std::string unit;
};

// A physical effect that may be missing from a model, on one joint. Regressors follow the sign of
// offnominal/model/effect.hpp: what the drive has to supply.
class EffectCandidate {
 public:
  virtual ~EffectCandidate() = default;

  // Name in robot files and in results.
  [[nodiscard]] virtual const char* name() const = 0;
  // The torque as a formula of the parameters.
  [[nodiscard]] virtual const char* formula() const = 0;
  // A noun phrase for the report: "friction that falls with speed near standstill".
  [[nodiscard]] virtual const char* words() const = 0;
  // Which motion shows it best.
  [[nodiscard]] virtual const char* motion_hint() const = 0;

  // Linear parameters, one per regressor.
  [[nodiscard]] virtual std::vector<LinearParameter> linear_parameters(JointType type) const = 0;
  // Shape parameters with grids that suit the recordings; none by default.
  [[nodiscard]] virtual std::vector<ShapeRange> shapes(const std::vector<Workspace>& at,
                                                       Eigen::Index joint) const;
  [[nodiscard]] virtual std::vector<Regressor> regressors(const Workspace& at, Eigen::Index joint,
                                                          std::span<const double> shape) const = 0;
  // What the user reads, from the fitted coefficients and the shape; by default the linear
  // parameters, then the shape's.
  [[nodiscard]] virtual std::vector<NamedValue> parameters(
      JointType type, const Eigen::VectorXd& coefficients, const ShapePoint& shape,
      const std::vector<ShapeRange>& ranges) const;
  // Whether fitted coefficients are physical: friction takes energy out, and an operator whose size
  // is in its shape has a coefficient near 1. True by default.
  [[nodiscard]] virtual bool is_physical(const Eigen::VectorXd& coefficients) const;
  // Whether the effect can act on this joint of the robot.
  [[nodiscard]] virtual bool applies(const Workspace& at, Eigen::Index joint) const;
  // Whether it acts on this joint where nothing moves: what hold maps are searched for.
  [[nodiscard]] virtual bool acts_at_rest(const Workspace& at, Eigen::Index joint) const;
  // Takes the place of the nuisance time skew (nuisance.hpp) once it is in the model. Its only
  // coefficient is a time then, and no discovery within what the skew may be.
  [[nodiscard]] virtual bool replaces_skew() const { return false; }
  // Its shape at a reversal becomes a nuisance once it is in the model.
  [[nodiscard]] virtual bool is_dry_friction() const { return false; }
  // Decided by forward simulation: the effect remembers, so that regression only screens it.
  [[nodiscard]] virtual bool has_memory() const { return false; }
  // The grid is a spectrum: it is screened by a periodogram over this variable.
  enum class Spectrum { kNone, kPosition, kTime };
  [[nodiscard]] virtual Spectrum spectrum() const { return Spectrum::kNone; }

 protected:
  // What remains of an operator's coefficient where the operator itself is the effect.
  [[nodiscard]] static bool is_near_one(double share) { return share > 0.6 && share < 1.5; }

  EffectCandidate() = default;
  EffectCandidate(const EffectCandidate&) = default;
  EffectCandidate& operator=(const EffectCandidate&) = default;
};

// Every effect that the analysis knows, in the order of results. An effect is one class in effects/
// and its name in effect_candidate.cpp.
const std::vector<std::unique_ptr<const EffectCandidate>>& all_candidates();

}  // namespace offnominal::tools::discovery
