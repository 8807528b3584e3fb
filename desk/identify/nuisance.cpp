#include "identify/nuisance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "identify/inertial_regressor.hpp"
#include "identify/unknown.hpp"
#include "signal/differentiate.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Of a link, as a length: how far its centre of mass is, or its radius of gyration.
double size_of(const Joint<double>& joint) {
  const auto& c = joint.centre_of_mass_m;
  const auto& inertia = joint.inertia_kg_m2;
  const double trace = inertia[0] + inertia[1] + inertia[2];
  const double gyration =
      joint.mass_kg > 0 ? std::sqrt(std::max(0.0, trace) / (2 * joint.mass_kg)) : 0;
  constexpr double kSmallestM = 0.01;
  return std::max({std::hypot(c[0], c[1], c[2]), gyration, kSmallestM});
}

// The link that was changed so.
Joint<double> unchanged(Joint<double> joint, const LinkChange& by) {
  joint.mass_kg /= by.factor;
  for (double& inertia : joint.inertia_kg_m2) inertia /= by.factor * by.inertia_factor;
  for (std::size_t axis = 0; axis < by.centre_m.size(); ++axis) {
    joint.centre_of_mass_m[axis] -= by.centre_m[axis];
  }
  return joint;
}

constexpr std::array<double, 3> kPreslidingShares{0.0002, 0.0006, 0.002};

// Not beyond +-most, which is two standard deviations.
Prior within(double most) { return {0, most / 2, -most, most}; }

// The same for an unknown that is counted from another value: `factor` times (1 + unknown) is 1 +
// what the prior is about.
Prior counted_from(const Prior& prior, double factor) {
  const auto moved = [&](double value) { return (1 + value) / factor - 1; };
  return {moved(prior.mean), prior.deviation / factor, moved(prior.low), moved(prior.high)};
}

class Builder {
 public:
  Builder(const RobotDescription& robot, const std::vector<Workspace>& recordings,
          const RowLayout& layout, const NuisanceOptions& options, InertialColumns& inertial)
      : robot_(robot),
        recordings_(recordings),
        layout_(layout),
        options_(options),
        inertial_(inertial),
        told_(recordings.size()) {}

  Nuisance build() {
    for (Index link = 0; options_.link_share > 0 && link < layout_.joint_count(); ++link) {
      add_link(link);
    }
    for (Index joint = 0; has_constants() && joint < layout_.joint_count(); ++joint) {
      if (!recordings_[0].knows(EffectKind::kTorqueScale, joint)) add_constant(joint);
    }
    for (std::size_t effect = 0; effect < robot_.effects.size(); ++effect) {
      if (is_free(effect)) add_effect(effect);
    }
    if (recordings_[0].at_rest) add_approach();
    const bool moves = !recordings_[0].at_rest;
    for (Index joint = 0; moves && joint < layout_.joint_count(); ++joint) {
      if (options_.sign_shapes) add_sign_shapes(joint);
      if (options_.skew_samples > 0) add_skew(joint);
    }
    for (const Term& change : options_.changes) add_change(change);
    Nuisance nuisance;
    nuisance.terms = std::move(terms_);
    nuisance.columns.resize(layout_.rows(), static_cast<Index>(columns_.size()));
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      nuisance.columns.col(static_cast<Index>(i)) = columns_[i];
    }
    return nuisance;
  }

 private:
  template <typename MakeRegressor>
  void add(NuisanceTerm term, const MakeRegressor& make) {
    std::vector<Regressor> regressors;
    for (const Workspace& at : recordings_) regressors.push_back(make(at));
    VectorXd column = layout_.stack(recordings_, regressors);
    terms_.push_back(std::move(term));
    columns_.push_back(std::move(column));
  }

  // `change`: of the link's numbers, in each recording.
  template <typename Change>
  void add_of_link(NuisanceTerm term, const MatrixXd& of_link, const Change& change) {
    VectorXd column(layout_.rows());
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      const auto& joints = recordings_[r].rigid.joints;
      const InertialNumbers numbers = change(joints[static_cast<std::size_t>(term.joint)].joint);
      const Index rows = layout_.samples(r) * layout_.joint_count();
      column.segment(layout_.begin(r, 0), rows) =
          of_link.middleRows(layout_.begin(r, 0), rows) * numbers;
    }
    terms_.push_back(std::move(term));
    columns_.push_back(std::move(column));
  }

  void add_link(Index link) {
    const LinkChange change =
        options_.links.empty() ? LinkChange{} : options_.links[static_cast<std::size_t>(link)];
    const auto of_link = inertial_.of_link(layout_, recordings_, link);
    add_of_link({NuisanceTerm::Kind::kLink, link, 0, 0,
                 counted_from(within(options_.link_share), change.factor),
                 fmt::format("mass and inertia of link {}", link + 1)},
                *of_link, inertial_numbers_of);
    if (!options_.link_geometry) return;
    add_of_link({NuisanceTerm::Kind::kLinkInertia, link, 0, 0,
                 counted_from(within(options_.link_share), change.inertia_factor),
                 fmt::format("inertia of link {}", link + 1)},
                *of_link, [](Joint<double> joint) {
                  joint.mass_kg = 0;
                  return inertial_numbers_of(joint);
                });
    for (std::size_t axis = 0; axis < change.centre_m.size(); ++axis) {
      add_centre(link, axis, change, *of_link);
    }
  }

  // `change`: by which the robot's link is off what the prior is about.
  void add_centre(Index link, std::size_t axis, const LinkChange& change, const MatrixXd& of_link) {
    const double moved = change.centre_m[axis];
    const double size =
        size_of(unchanged(robot_.joints[static_cast<std::size_t>(link)].joint, change));
    Prior prior = within(options_.link_share * size);
    prior.mean -= moved;
    prior.low -= moved;
    prior.high -= moved;
    add_of_link({NuisanceTerm::Kind::kLinkCentre, link, 0, axis, prior,
                 fmt::format("centre of mass of link {}", link + 1)},
                of_link, [&](const Joint<double>& joint) -> InertialNumbers {
                  // Quadratic in the centre of mass: a central difference is the derivative.
                  const double step = 0.1 * size;
                  const auto numbers_at = [&](double by) {
                    Joint<double> there = joint;
                    there.centre_of_mass_m[axis] += by;
                    return inertial_numbers_of(there);
                  };
                  return (numbers_at(step) - numbers_at(-step)) / (2 * step);
                });
  }

  // One joint alone, or gravity alone, does not tell them from masses.
  [[nodiscard]] bool has_constants() const {
    return options_.torque_constant > 0 && layout_.joint_count() > 1 && !recordings_[0].at_rest;
  }

  // Of what the model has, as the candidate is. Of what is measured it would take a share of any
  // error, and of a held-out one too.
  void add_constant(Index joint) {
    add({NuisanceTerm::Kind::kConstant, joint, 0, 0, within(options_.torque_constant),
         fmt::format("torque constant of joint {}", joint + 1)},
        [&](const Workspace& at) -> Regressor {
          return {{joint, at.model_torque.col(joint)}};
        });
  }

  [[nodiscard]] bool is_free(std::size_t effect) const {
    const auto& free = options_.free_effects;
    return !free || std::find(free->begin(), free->end(), effect) != free->end();
  }

  [[nodiscard]] Prior prior_of(std::size_t effect, std::size_t parameter) const {
    Prior prior;
    for (const KnownNumber& one : options_.known) {
      if (one.effect != effect || one.parameter != parameter) continue;
      prior.low = one.low;
      prior.high = one.high;
    }
    return prior;
  }

  void add_effect(std::size_t effect) {
    for (const Unknown& unknown : unknowns_of_effect(robot_, effect, false)) {
      add({NuisanceTerm::Kind::kKnownEffect, static_cast<Index>(unknown.joint), effect,
           unknown.parameter, prior_of(effect, unknown.parameter), name_of(robot_, unknown)},
          [&](const Workspace& at) {
            Regressor columns;
            auto& told = told_[static_cast<std::size_t>(&at - recordings_.data())];
            for (JointColumn& column :
                 regressor(at.as_recorded(robot_), unknown, at.motion, told)) {
              columns.push_back({static_cast<Index>(column.joint), std::move(column.values)});
            }
            return columns;
          });
    }
  }

  [[nodiscard]] double range_of(Index joint) const {
    return options_.ranges_moved.size() > 0 ? options_.ranges_moved[joint]
                                            : range_moved(recordings_, joint);
  }

  // How dry friction builds up at a reversal is never quite the file's smoothed sign: a wider one,
  // and a Dahl operator of several widths, each a share of the range moved.
  void add_sign_shapes(Index joint) {
    // No more of it than the joint's torque: stretches without a reversal say nothing of it, and a
    // fit of those would predict the others by whatever their noise says.
    double squares = 0;
    double samples = 0;
    for (const Workspace& at : recordings_) {
      squares += at.torque.col(joint).squaredNorm();
      samples += static_cast<double>(at.sample_count());
    }
    const double torque = std::sqrt(squares / samples);
    const Prior prior = torque > 0 ? within(torque) : Prior{};
    const auto add_shape = [&](const std::string& name, const auto& shape) {
      add({NuisanceTerm::Kind::kSignShape, joint, 0, 0, prior,
           fmt::format("{} of joint {}", name, joint + 1)},
          [&](const Workspace& at) -> Regressor {
            return {{joint, shape(at)}};
          });
    };
    add_shape("wider sign", [&](const Workspace& at) -> VectorXd {
      return (at.motion.dq.col(joint).array() / (4 * at.sign_width[joint])).tanh() - at.sign(joint);
    });
    // Of a stuck encoder nothing builds up, and the columns are 0: any data of one robot have the
    // same terms.
    constexpr double kLeast = 1e-9;
    const double range = std::max(range_of(joint), kLeast);
    for (const double share : kPreslidingShares) {
      add_shape(fmt::format("pre-sliding over {:.2g}", share * range),
                [&](const Workspace& at) -> VectorXd {
                  return at.dahl_state(joint, share * range).array() - at.sign(joint);
                });
    }
  }

  void add_approach() {
    for (Index joint = 0; joint < layout_.joint_count(); ++joint) {
      if (!recordings_[0].both_ways(joint)) continue;
      add({NuisanceTerm::Kind::kApproach,
           joint,
           0,
           0,
           {},
           fmt::format("friction by direction of approach of joint {}", joint + 1)},
          [&](const Workspace& at) -> Regressor {
            return {{joint, at.approach.col(joint)}};
          });
    }
  }

  void add_skew(Index joint) {
    double period_s = 0;
    for (const Workspace& at : recordings_) period_s = std::max(period_s, at.skew_s);
    const double most = options_.skew_samples * period_s;
    add({NuisanceTerm::Kind::kSkew, joint, 0, 0, within(most),
         fmt::format("time skew of joint {}", joint + 1)},
        [&](const Workspace& at) -> Regressor {
          return {{joint, central_difference(at.torque.col(joint), at.period_s())}};
        });
  }

  void add_change(const Term& change) {
    const MatrixXd columns =
        within(shares_of(*change.during, recordings_), layout_,
               stacked_columns(layout_, recordings_, *change.effect, change.joint, change.shape));
    for (Index c = 0; c < columns.cols(); ++c) {
      terms_.push_back({NuisanceTerm::Kind::kChange,
                        change.joint,
                        0,
                        0,
                        {},
                        fmt::format("{} of joint {}, {}", change.effect->name(), change.joint + 1,
                                    words_of(*change.during))});
      columns_.emplace_back(columns.col(c));
    }
  }

  const RobotDescription& robot_;
  const std::vector<Workspace>& recordings_;
  const RowLayout& layout_;
  const NuisanceOptions& options_;
  InertialColumns& inertial_;
  std::vector<std::optional<ToldTorque>> told_;  // per recording, where it was needed
  std::vector<NuisanceTerm> terms_;
  std::vector<VectorXd> columns_;
};

}  // namespace

double LinkChange::largest(double size_m) const {
  double most = std::max(std::abs(factor - 1), std::abs(factor * inertia_factor - 1));
  for (const double by : centre_m) {
    if (by != 0) most = std::max(most, std::abs(by) / size_m);
  }
  return most;
}

double size_of_link(const RobotDescription& robot, std::size_t link) {
  return size_of(robot.joints[link].joint);
}

Nuisance make_nuisance(const RobotDescription& robot, const std::vector<Workspace>& recordings,
                       const RowLayout& layout, const NuisanceOptions& options,
                       InertialColumns& inertial) {
  return Builder(robot, recordings, layout, options, inertial).build();
}

}  // namespace offnominal::desk
