#include "identify/sign_width.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <string_view>

#include "identify/shape_grid.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Index followed_joint(const Effect<double>& effect) {
  const auto parameters = info_of(effect.kind)->parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].quantity == Quantity::kJointNumber) {
      return static_cast<Index>(effect.parameters[i]) - 1;
    }
  }
  return effect.joint;
}

Index followed_joint(const Term& term) {
  for (std::size_t i = 0; i < term.ranges.size(); ++i) {
    const ParameterInfo* joint_number = term.effect->info().find(Quantity::kJointNumber);
    if (joint_number != nullptr && term.ranges[i].name == joint_number->name) {
      return static_cast<Index>(term.shape[i]) - 1;
    }
  }
  return term.joint;
}

std::size_t width_of(EffectKind kind) {
  const auto parameters = info_of(kind)->parameters;
  std::size_t i = 0;
  while (i < parameters.size() &&
         parameters[i].name != std::string_view(effects::kSmoothing.name)) {
    ++i;
  }
  return i;
}

namespace {

bool has_width(EffectKind kind) { return width_of(kind) < info_of(kind)->parameters.size(); }

// Widths of motors are their effects' own.
bool follows(const Effect<double>& effect, Index joint) {
  return !effect.of_motor && has_width(effect.kind) && followed_joint(effect) == joint;
}

bool follows(const Term& term, Index joint) {
  return !term.effect->of_motor() && has_width(term.effect->kind()) &&
         followed_joint(term) == joint;
}

// Where a term's width is among its shapes; their number where it is not.
std::size_t width_among_shapes(const Term& term) {
  std::size_t axis = 0;
  while (axis < term.ranges.size() && term.ranges[axis].name != effects::kSmoothing.name) ++axis;
  return axis;
}

bool is_listed(const std::vector<std::size_t>& list, std::size_t one) {
  return std::find(list.begin(), list.end(), one) != list.end();
}

// A fitted model as a function of one joint's width.
class WidthModel {
 public:
  WidthModel(const Data& data, const RobotDescription& robot, const std::vector<Term>& terms,
             const ModelFit& fit, Index joint)
      : data_(data), robot_(robot), terms_(terms), fit_(fit), joint_(joint), at_(data.recordings) {}

  // The torque of the robot's own effects that follow the joint, stacked.
  [[nodiscard]] VectorXd known_torque(double width) {
    VectorXd torque = VectorXd::Zero(data_.layout.rows());
    for (const RobotEffect& effect : robot_.effects) {
      if (!follows(effect, joint_)) continue;
      torque += stacked([&](const Workspace& at) {
        return torque_of(at, with(static_cast<const Effect<double>&>(effect), width));
      });
    }
    return torque;
  }

  // The column of a nuisance term; it follows the joint.
  [[nodiscard]] VectorXd known_column(const NuisanceTerm& term, double width) {
    Effect<double> unit =
        with(static_cast<const Effect<double>&>(robot_.effects[term.effect]), width);
    const auto parameters = info_of(unit.kind)->parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      if (parameters[i].role == ParameterRole::kLinear) unit.parameters[i] = i == term.parameter;
    }
    return stacked([&](const Workspace& at) { return torque_of(at, unit); });
  }

  [[nodiscard]] bool follows_joint(const NuisanceTerm& term) const {
    return term.kind == NuisanceTerm::Kind::kKnownEffect &&
           follows(robot_.effects[term.effect], joint_);
  }

  [[nodiscard]] MatrixXd columns(const Term& term, double width) {
    for (Workspace& at : at_) at.sign_width[joint_] = width;
    ShapePoint shape = term.shape;
    const std::size_t own = width_among_shapes(term);
    if (own < shape.size()) shape[own] = width;
    return stacked_columns(data_.layout, at_, *term.effect, term.joint, shape);
  }

  [[nodiscard]] double width() const { return data_.recordings[0].sign_width[joint_]; }

  // All that depends on the width, at the fit's numbers.
  [[nodiscard]] VectorXd torque(double width) {
    VectorXd whole = known_torque(width);
    for (std::size_t i = 0; i < data_.nuisance.terms.size(); ++i) {
      if (!follows_joint(data_.nuisance.terms[i])) continue;
      whole += fit_.nuisance[static_cast<Index>(i)] * known_column(data_.nuisance.terms[i], width);
    }
    for (std::size_t i = 0; i < terms_.size(); ++i) {
      if (follows(terms_[i], joint_)) whole += columns(terms_[i], width) * fit_.coefficients[i];
    }
    return whole;
  }

 private:
  static Effect<double> with(Effect<double> effect, double width) {
    effect.parameters[width_of(effect.kind)] = width;
    return effect;
  }

  template <typename Make>
  [[nodiscard]] VectorXd stacked(const Make& make) const {
    std::vector<Regressor> regressors;
    for (const Workspace& at : data_.recordings) regressors.push_back(make(at));
    return data_.layout.stack(data_.recordings, regressors);
  }

  const Data& data_;
  const RobotDescription& robot_;
  const std::vector<Term>& terms_;
  const ModelFit& fit_;
  Index joint_;
  std::vector<Workspace> at_;
};

// The joints whose torque depends on the width, and the regression that belongs to them alone.
class WidthSearch {
 public:
  WidthSearch(const Data& data, const RobotDescription& robot, const std::vector<Term>& terms,
              const ModelFit& fit, Index joint)
      : data_(data),
        terms_(terms),
        fit_(fit),
        joint_(joint),
        model_(data, robot, terms, fit, joint) {
    is_concerned_.assign(static_cast<std::size_t>(data.layout.joint_count()), 0);
    for (const RobotEffect& effect : robot.effects) {
      if (follows(effect, joint)) is_concerned_[effect.joint] = 1;
    }
    for (const Term& term : terms) {
      if (follows(term, joint)) is_concerned_[static_cast<std::size_t>(term.joint)] = 1;
    }
    weights_ = fit.joint_weights;
    for (Index j = 0; j < weights_.size(); ++j) {
      if (is_concerned_[static_cast<std::size_t>(j)] == 0) weights_[j] = 0;
    }
    set_up_columns();
    // What the regression leaves, and what its own columns take of it, without the width's part.
    rest_ = fit.residual + model_.torque(model_.width());
    for (Index c = 0; c < columns_.cols(); ++c) {
      rest_ += columns_.col(c) * values_[static_cast<std::size_t>(c)];
    }
    // A skew is the recordings' own: it makes up for a width that a robot file then has without it.
    for (std::size_t i = 0; i < data.nuisance.terms.size(); ++i) {
      if (data.nuisance.terms[i].kind != NuisanceTerm::Kind::kSkew) continue;
      const auto column = static_cast<Index>(i);
      rest_ += data.nuisance.columns.col(column) * fit.nuisance[column];
    }
  }

  [[nodiscard]] double energy(double width) {
    MatrixXd columns = columns_;
    std::vector<Prior> priors = priors_;
    const auto add = [&](const VectorXd& column, const Prior& prior) {
      columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
      columns.rightCols(1) = column;
      priors.push_back(prior);
    };
    for (const NuisanceTerm& one : data_.nuisance.terms) {
      if (model_.follows_joint(one)) add(model_.known_column(one, width), one.prior);
    }
    for (const Term& term : terms_) {
      if (!follows(term, joint_)) continue;
      const MatrixXd own = model_.columns(term, width);
      for (Index c = 0; c < own.cols(); ++c) {
        const auto at = static_cast<std::size_t>(c);
        const bool given = at < term.given.size() && term.given[at];
        add(own.col(c), given ? Prior::at(*term.given[at]) : Prior{});
      }
    }
    const VectorXd row_weights =
        data_.layout.weighted(VectorXd::Ones(data_.layout.rows()), weights_);
    return least_squares_with_priors(
               concerned(row_weights.asDiagonal() * columns),
               concerned(row_weights.cwiseProduct(rest_ - model_.known_torque(width))), priors,
               fit_.prior_weight)
        .residual.squaredNorm();
  }

  [[nodiscard]] double best() {
    const double present = model_.width();
    double top = 0;
    for (const Workspace& at : data_.recordings) top = std::max(top, at.top_speed[joint_]);
    constexpr double kNarrowest = 1e-3;
    constexpr double kWidest = 0.3;
    constexpr double kPerDecade = 4;
    const std::vector<double> grid = logarithmic_grid(kNarrowest * top, kWidest * top, kPerDecade);
    if (grid.empty()) return present;
    std::vector<double> energies;
    for (const double width : grid) energies.push_back(energy(width));
    const auto least = static_cast<std::size_t>(std::min_element(energies.begin(), energies.end()) -
                                                energies.begin());
    const double low = std::log(grid[least > 0 ? least - 1 : 0]);
    const double high = std::log(grid[std::min(least + 1, grid.size() - 1)]);
    constexpr int kBits = 16;
    std::uintmax_t most = 25;
    const auto [found, left] = boost::math::tools::brent_find_minima(
        [&](double x) { return energy(std::exp(x)); }, low, high, kBits, most);
    constexpr double kAsGood = 1e-6;
    const bool better = left < (1 - kAsGood) * energy(present);
    return better ? std::exp(found) : present;
  }

 private:
  // What acts on the joints concerned, and on them alone, and does not depend on the width.
  void set_up_columns() {
    const Regression::Design design = Regression(data_).design(terms_);
    std::vector<Index> own;
    const auto take = [&](Index column, double value) {
      const VectorXd energy = data_.layout.energy(design.columns.col(column));
      bool alone = energy.sum() > 0;
      for (Index j = 0; j < energy.size(); ++j) {
        alone = alone && (energy[j] == 0 || is_concerned_[static_cast<std::size_t>(j)] != 0);
      }
      if (!alone) return;
      own.push_back(column);
      values_.push_back(value);
      priors_.push_back(design.priors[static_cast<std::size_t>(column)]);
    };
    for (std::size_t i = 0; i < design.kept.size(); ++i) {
      const NuisanceTerm& term = data_.nuisance.terms[static_cast<std::size_t>(design.kept[i])];
      if (model_.follows_joint(term) || term.kind == NuisanceTerm::Kind::kSkew) continue;
      take(static_cast<Index>(i), fit_.nuisance[design.kept[i]]);
    }
    for (std::size_t i = 0; i < terms_.size(); ++i) {
      if (follows(terms_[i], joint_)) continue;
      for (Index c = design.first[i]; c < design.first[i + 1]; ++c) {
        take(c, fit_.coefficients[i][c - design.first[i]]);
      }
    }
    columns_ = design.columns(Eigen::all, own);
  }

  // The rows of the joints concerned.
  template <typename Values>
  [[nodiscard]] MatrixXd concerned(const Values& values) const {
    const MatrixXd all = values;
    const RowLayout& layout = data_.layout;
    std::vector<Index> rows;
    for (std::size_t r = 0; r < layout.recording_count(); ++r) {
      for (Index j = 0; j < layout.joint_count(); ++j) {
        if (is_concerned_[static_cast<std::size_t>(j)] == 0) continue;
        for (Index i = 0; i < layout.samples(r); ++i) rows.push_back(layout.begin(r, j) + i);
      }
    }
    return all(rows, Eigen::all);
  }

  const Data& data_;
  const std::vector<Term>& terms_;
  const ModelFit& fit_;
  Index joint_;
  WidthModel model_;
  std::vector<char> is_concerned_;
  VectorXd weights_;
  MatrixXd columns_;
  std::vector<double> values_;
  std::vector<Prior> priors_;
  VectorXd rest_;
};

}  // namespace

void set_sign_width(RobotDescription& robot, Index joint, double width) {
  for (RobotEffect& effect : robot.effects) {
    if (follows(effect, joint)) effect.parameters[width_of(effect.kind)] = width;
  }
}

void hold_sign_width(Term& term, Index joint, double width) {
  const std::size_t own = width_among_shapes(term);
  if (own >= term.ranges.size() || !follows(term, joint)) return;
  term.ranges[own].grid = {width};
  term.ranges[own].kind = ShapeRange::Kind::kDiscrete;
  term.shape[own] = width;
}

double searched_sign_width(const std::vector<Term>& terms, Index joint) {
  for (const Term& term : terms) {
    const std::size_t own = width_among_shapes(term);
    if (own < term.ranges.size() && follows(term, joint)) return term.shape[own];
  }
  return 0;
}

VectorXd settled_sign_widths(const RobotDescription& robot,
                             const std::vector<std::size_t>& fitted_effects) {
  VectorXd settled = VectorXd::Zero(robot.joint_count());
  for (std::size_t i = 0; i < robot.effects.size(); ++i) {
    const RobotEffect& effect = robot.effects[i];
    if (effect.of_motor || !has_width(effect.kind) || is_listed(fitted_effects, i)) continue;
    double& width = settled[followed_joint(effect)];
    if (!(width > 0)) width = effect.parameters[width_of(effect.kind)];
  }
  return settled;
}

std::vector<Index> joints_with_free_width(const RobotDescription& robot,
                                          const std::vector<std::size_t>& fitted_effects,
                                          const std::vector<Term>& terms, const VectorXd& settled) {
  std::vector<Index> joints;
  for (Index joint = 0; joint < robot.joint_count(); ++joint) {
    bool is_followed = std::any_of(terms.begin(), terms.end(),
                                   [&](const Term& term) { return follows(term, joint); });
    for (const std::size_t i : fitted_effects) {
      is_followed = is_followed || follows(robot.effects[i], joint);
    }
    if (is_followed && !(settled[joint] > 0)) joints.push_back(joint);
  }
  return joints;
}

double best_sign_width(const Data& data, const RobotDescription& robot,
                       const std::vector<Term>& terms, const ModelFit& fit, Index joint) {
  return WidthSearch(data, robot, terms, fit, joint).best();
}

VectorXd width_derivative(const Data& data, const RobotDescription& robot,
                          const std::vector<Term>& terms, const ModelFit& fit, Index joint) {
  constexpr double kStep = 1e-2;
  WidthModel model(data, robot, terms, fit, joint);
  const double width = model.width();
  return (model.torque((1 + kStep) * width) - model.torque((1 - kStep) * width)) /
         (2 * kStep * width);
}

}  // namespace offnominal::desk
