#include "inertial/inertial_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "compare/inverse_model.hpp"
#include "identify/held_out_parts.hpp"
#include "identify/independent_samples.hpp"
#include "identify/physical_range.hpp"
#include "identify/sign_width.hpp"
#include "identify/torque_scale.hpp"
#include "identify/unknown.hpp"
#include "inertial/link_prior.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

InertialFit::InertialFit(const RobotDescription& file, const IdentifyRequest& request,
                         const std::vector<Log>& logs, const FilterPlan& plan, Rotors rotors,
                         const OnProgress& on_progress)
    : file_(file), request_(request), logs_(logs), plan_(plan), robot_(file), rotors_(rotors) {
  const auto say = [&](const char* doing) {
    if (on_progress) on_progress(doing);
  };
  say("preparing the recordings");
  set_links();
  RobotDescription narrowed = robot_;
  const VectorXd narrow = set_sign_widths(narrowed, logs_, plan_);
  stretches_ = stretches_of(logs_, robot_, plan_);
  recordings_ = searched_workspaces(stretches_, robot_, plan_, narrow);
  find_standing();
  scale_geometry();
  choose_drives();
  set_inertial_columns();
  say("fitting links and drives");
  build();
  fit_widths();
  say("judging by parts that are held out");
  choose_share();
}

bool InertialFit::is_known(std::size_t link) const {
  return !request_.from_geometry && has_numbers(file_, link);
}

void InertialFit::set_links() {
  const std::vector<Joint<double>> geometry = joints_of_geometry(file_);
  for (std::size_t link = 0; link < robot_.joints.size(); ++link) {
    if (!is_known(link)) robot_.joints[link].joint = geometry[link];
    if (!request_.payload || link + 1 == robot_.joints.size()) base_.links.push_back(link);
  }
  nuisance_.link_share = 0;
  nuisance_.sign_shapes = false;
}

// A joint that nobody moved says nothing of its drive, and what it holds is held by friction too.
void InertialFit::find_standing() {
  constexpr double kStands = 1e-3;  // rad or m
  for (Index joint = 0; joint < robot_.joint_count(); ++joint) {
    base_.moves.push_back(static_cast<char>(range_moved(recordings_, joint) >= kStands));
    base_.stands_at.push_back(recordings_[0].motion.q.col(joint).mean());
  }
}

// The geometry says where the mass of an arm is, one number for all links how much there is.
void InertialFit::scale_geometry() {
  std::vector<std::size_t> unknown;
  for (std::size_t link = 0; link < robot_.joints.size(); ++link) {
    if (!is_known(link)) unknown.push_back(link);
  }
  if (unknown.empty()) return;
  drives_ = drive_model(robot_, drive_request({}, false));
  const Data data(recordings_, robot_, nuisance_);
  const std::vector<Term> terms = terms_of(drives_, data);
  const Regression::Design design = Regression(data).design(terms);
  std::vector<MatrixXd> torques;
  for (const Workspace& at : data.recordings) {
    MatrixXd torque = MatrixXd::Zero(at.motion.q.rows(), at.motion.q.cols());
    for (const std::size_t link : unknown) torque += link_torque(at.rigid, link, at.motion);
    torques.push_back(std::move(torque));
  }
  std::vector<const MatrixXd*> of_links;
  for (const MatrixXd& one : torques) of_links.push_back(&one);
  MatrixXd columns(data.layout.rows(), design.columns.cols() + 1);
  columns << data.layout.stack_all(data.recordings, of_links), design.columns;
  VectorXd weights = data.layout.rms(data.torque);
  weights = weights.cwiseMax(1e-9 * weights.maxCoeff() + 1e-300).cwiseInverse();
  const VectorXd of_rows = data.layout.weighted(VectorXd::Ones(data.layout.rows()), weights);
  std::vector<Prior> priors = design.priors;
  // Of 1 kg/m: between a straw and a bridge.
  constexpr double kLightest = 0.01;
  constexpr double kHeaviest = 1e4;
  Prior heavier;
  heavier.low = kLightest - 1;
  heavier.high = kHeaviest - 1;
  priors.insert(priors.begin(), heavier);
  const PriorFit fit = least_squares_with_priors(of_rows.asDiagonal() * columns,
                                                 of_rows.cwiseProduct(data.target), priors, 1);
  // Where the mass is in another place than the bars have it, their weight may fit to nothing, or
  // worse. Then as much as makes torques of the size that was measured.
  constexpr double kTooLight = 0.1;
  const double size = columns.col(0).cwiseProduct(of_rows).norm();
  const double measured = data.torque.cwiseProduct(of_rows).norm();
  const double by_size = size > 0 ? std::clamp(measured / size, kLightest, kHeaviest) : 1;
  const double heavier_by = std::max(1 + fit.x[0], kTooLight * by_size);
  for (const std::size_t link : unknown) {
    Joint<double>& joint = robot_.joints[link].joint;
    joint.mass_kg *= heavier_by;
    for (double& inertia : joint.inertia_kg_m2) inertia *= heavier_by;
  }
  for (Workspace& at : recordings_) at.set_model(robot_);
}

DriveRequest InertialFit::drive_request(std::vector<std::size_t> rotors, bool keep) const {
  DriveRequest request{base_.moves, std::move(rotors), keep, recordings_[0].of_sensor};
  for (std::size_t joint = 0; joint < request.of_sensor.size(); ++joint) {
    for (const Workspace& at : recordings_) {
      if (!at.sees_drive(static_cast<Index>(joint))) request.of_sensor[joint] = 1;
    }
  }
  request.payload = std::any_of(recordings_.begin(), recordings_.end(),
                                [](const Workspace& at) { return at.payload.has_value(); });
  return request;
}

void InertialFit::choose_drives() {
  if (request_.payload) {
    drives_ = {};
  } else {
    base_.rotors.clear();
    const DriveRequest all = drive_request({}, request_.keep);
    for (std::size_t joint = 0; joint < robot_.joints.size(); ++joint) {
      const bool shows = moves(joint) && all.shows(EffectKind::kRotorInertia, joint);
      // A motor's rotor stays as the file has it.
      const bool of_motor =
          std::any_of(file_.effects.begin(), file_.effects.end(), [&](const RobotEffect& one) {
            return one.of_motor && one.kind == EffectKind::kRotorInertia &&
                   acts_on_joint(file_, one, static_cast<Index>(joint));
          });
      if (shows && !of_motor) base_.rotors.push_back(joint);
    }
    const std::vector<std::size_t> apart = rotors_apart(robot_, base_);
    const bool all_rotors = rotors_ == Rotors::kAll;
    drives_ = drive_model(robot_, drive_request(all_rotors ? base_.rotors : apart, request_.keep));
    // What the links are named beside: rotors of the file and new ones.
    std::erase_if(base_.rotors, [&](std::size_t joint) {
      if (std::find(apart.begin(), apart.end(), joint) != apart.end()) return false;
      const bool is_in_file =
          std::any_of(file_.effects.begin(), file_.effects.end(), [&](const RobotEffect& one) {
            return one.joint == joint && !one.of_motor && one.kind == EffectKind::kRotorInertia;
          });
      if (is_in_file) return false;
      untold_rotors_.push_back(joint);
      return !all_rotors;
    });
  }
  nuisance_.free_effects = drives_.refitted;
  settled_ = settled_sign_widths(file_, drives_.refitted);
  for (Index joint = 0; joint < settled_.size(); ++joint) {
    // Where one is settled, effects that share the joint may have others: they stay.
    const bool settled = settled_[joint] > 0;
    if (!settled) set_width(joint, recordings_[0].sign_width[joint]);
    for (Workspace& at : recordings_) {
      if (settled) at.sign_width[joint] = settled_[joint];
    }
  }
}

// What a link asks of the joints before it, behind what is between drive and load.
void InertialFit::set_inertial_columns() {
  const RowLayout layout(recordings_);
  of_links_.resize(layout.rows(), static_cast<Index>(base_.links.size()) * kInertialNumbers);
  Index at_column = 0;
  for (const std::size_t link : base_.links) {
    about_.push_back(upper_factor_of(believed_inertia(robot_, link)));
    Unknown of_link;
    of_link.kind = Unknown::Kind::kLinkScale;
    of_link.joint = link;
    std::vector<std::vector<Regressor>> numbers(static_cast<std::size_t>(kInertialNumbers));
    for (const Workspace& at : recordings_) {
      const std::vector<MatrixXd> torques = inertial_regressor(robot_, link, at.motion);
      const bool has_path = has_path_effect(robot_);
      const ToldTorque told = has_path ? told_torque(robot_, at.motion) : ToldTorque{};
      for (std::size_t number = 0; number < numbers.size(); ++number) {
        std::vector<JointColumn> columns;
        for (std::size_t joint = 0; joint <= link; ++joint) {
          columns.push_back({joint, torques[number].col(static_cast<Index>(joint))});
        }
        if (has_path) pass_path(robot_, of_link, told, columns);
        Regressor regressor;
        for (JointColumn& column : columns) {
          regressor.push_back({static_cast<Index>(column.joint), std::move(column.values)});
        }
        numbers[number].push_back(std::move(regressor));
      }
    }
    for (const std::vector<Regressor>& number : numbers) {
      of_links_.col(at_column++) = layout.stack(recordings_, number);
    }
  }
}

// The links that were found become those that the data are made with, so that what the engine fits
// beside them knows them.
void InertialFit::adopt_links() {
  for (std::size_t i = 0; i < model_.links.size(); ++i) {
    const ConsistentModel::Link& link = model_.links[i];
    put_inertia(inertial_numbers_at(link.about, point_.links[i]), robot_.joints[link.link].joint);
  }
}

void InertialFit::set_width(Index joint, double width) {
  set_sign_width(robot_, joint, width);
  for (Workspace& at : recordings_) at.sign_width[joint] = width;
}

void InertialFit::build() {
  for (Workspace& at : recordings_) at.set_model(robot_);
  data_ = std::make_unique<Data>(recordings_, robot_, nuisance_);
  std::vector<char> rows(static_cast<std::size_t>(data_->layout.rows()), 1);
  const RowLayout& layout = data_->layout;
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    for (Index joint = 0; joint < layout.joint_count(); ++joint) {
      if (moves(static_cast<std::size_t>(joint))) continue;
      std::fill_n(rows.begin() + layout.begin(r, joint), layout.samples(r), char{0});
    }
  }
  data_->layout.leave_out(rows);
  regression_ = std::make_unique<Regression>(*data_);
  terms_ = terms_of(drives_, *data_);
  design_ = regression_->design(terms_);
  columns_.resize(layout.rows(), design_.columns.cols() + of_links_.cols());
  columns_ << design_.columns, of_links_;
  model_ = {};
  model_.columns = columns_.cols();
  Index first = design_.columns.cols();
  for (std::size_t i = 0; i < base_.links.size(); ++i) {
    const Joint<double>& joint = robot_.joints[base_.links[i]].joint;
    model_.links.push_back({base_.links[i], first, about_[i], inertial_numbers_of(joint)});
    first += kInertialNumbers;
  }
  add_linear_numbers(robot_, *data_, design_, terms_, model_);
  reduced_ =
      std::make_unique<ReducedRows>(columns_, data_->target, layout,
                                    held_out_parts(layout, recordings_[0].at_rest), kHeldOutParts);
  if (point_.linear.size() != static_cast<Index>(model_.linear.size())) point_ = start_of(model_);
}

VectorXd InertialFit::residual() const {
  return data_->target - columns_ * columns_at(model_, point_);
}

// Weights, and what a prior weighs, follow from the error that is left.
void InertialFit::solve(double share, int passes) {
  const RowLayout& layout = data_->layout;
  const double floor = 1e-6 * layout.rms(data_->torque).maxCoeff() + 1e-300;
  if (weights_.size() == 0) {
    weights_ = layout.rms(data_->torque).cwiseMax(floor).cwiseInverse();
  }
  for (int pass = 0; pass < passes; ++pass) {
    point_ = consistent_fit(model_, reduced_->weighted(weights_), share, prior_weight_, point_);
    weights_ = reduced_->rms(columns_at(model_, point_)).cwiseMax(floor).cwiseInverse();
    double rows = 0;
    for (std::size_t r = 0; r < layout.recording_count(); ++r) {
      for (Index joint = 0; joint < layout.joint_count(); ++joint) {
        rows += layout.moving_count(r, joint);
      }
    }
    const double independent = independent_samples_of(layout, residual()).sum();
    prior_weight_ = independent > 0 && rows > independent ? std::sqrt(rows / independent) : 1;
  }
}

std::vector<double> InertialFit::shares() const {
  if (request_.payload) return {1, 3};
  for (const std::size_t link : base_.links) {
    if (!is_known(link)) return {0.7, 1.5, 3};
  }
  return {0.05, 0.15, 0.5, 1};
}

// A width and what else is fitted depend on each other: in turn.
void InertialFit::fit_widths() {
  constexpr int kTurns = 2;
  const std::vector<double> all = shares();
  const double share = all[all.size() / 2];
  widths_ = joints_with_free_width(file_, drives_.refitted, terms_, settled_);
  std::erase_if(widths_, [&](Index joint) { return !moves(static_cast<std::size_t>(joint)); });
  for (int turn = 0; turn < kTurns && !widths_.empty(); ++turn) {
    solve(share, 2);
    adopt_links();
    build();
    const ModelFit fit = model_fit();
    std::vector<double> best;
    for (const Index joint : widths_) {
      best.push_back(best_sign_width(*data_, robot_, terms_, fit, joint));
    }
    for (std::size_t i = 0; i < widths_.size(); ++i) set_width(widths_[i], best[i]);
    build();
  }
  solve(share, 2);
}

// What is the recordings' own, and no file has: then the error is that of the file.
VectorXd InertialFit::without_skew(VectorXd x) const {
  for (std::size_t i = 0; i < design_.kept.size(); ++i) {
    const auto term = static_cast<std::size_t>(design_.kept[i]);
    if (data_->nuisance.terms[term].kind == NuisanceTerm::Kind::kSkew) x[static_cast<Index>(i)] = 0;
  }
  return x;
}

// How far the links are to be believed, the held-out parts say; where it is all the same to them,
// the more.
void InertialFit::choose_share() {
  constexpr double kAsGood = 1.01;
  const std::vector<double> all = shares();
  const std::vector<int> parts = reduced_->parts();
  share_ = all[all.size() / 2];
  if (parts.size() > 1) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = all.size(); i-- > 0;) {
      const double share = all[i];
      VectorXd energy = VectorXd::Zero(data_->layout.joint_count());
      for (const int part : parts) {
        const ConsistentPoint without = consistent_fit(model_, reduced_->weighted(weights_, part),
                                                       share, prior_weight_, point_);
        energy += reduced_->energy(without_skew(columns_at(model_, without)), part);
      }
      const double weighted = weights_.cwiseAbs2().dot(energy);
      if (weighted > kAsGood * least) continue;
      least = std::min(least, weighted);
      share_ = share;
      held_out_energy_ = energy;
    }
  }
  solve(share_, 3);
}

ModelFit InertialFit::model_fit() const {
  const RowLayout& layout = data_->layout;
  const VectorXd x = columns_at(model_, point_);
  ModelFit fit;
  fit.nuisance = VectorXd::Zero(data_->nuisance.columns.cols());
  for (std::size_t i = 0; i < design_.kept.size(); ++i) {
    fit.nuisance[design_.kept[i]] = x[static_cast<Index>(i)];
  }
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    fit.coefficients.push_back(
        x.segment(design_.first[i], design_.first[i + 1] - design_.first[i]));
  }
  fit.residual = residual();
  fit.joint_weights = weights_;
  fit.prior_weight = prior_weight_;
  fit.remainder.layout = &layout;
  fit.remainder.joint_weights = weights_;
  fit.remainder.prior_weight = prior_weight_;
  fit.remainder.blocks = layout.blocks(kShortestBlockS);
  return fit;
}

void InertialFit::put_links(RobotDescription& robot) const {
  for (std::size_t i = 0; i < model_.links.size(); ++i) {
    const ConsistentModel::Link& link = model_.links[i];
    RobotJoint& joint = robot.joints[link.link];
    put_inertia(inertial_numbers_at(link.about, point_.links[i]), joint.joint);
    if (!joint.source.empty()) joint.source += " ";
    joint.source += "Mass, centre of mass and inertia: " + request_.source;
  }
}

bool is_nothing(const Term& term, const VectorXd& coefficients) {
  constexpr double kRounding = 1e-12;
  const PhysicalRange range = physical_range(term.effect->kind(), 0);
  return range.min >= 0 && coefficients[0] <= range.min + kRounding;
}

void InertialFit::put_drives(RobotDescription& robot) const {
  const ModelFit fit = model_fit();
  const VectorXd& sign_width = data_->recordings[0].sign_width;
  for (std::size_t i = 0; i < data_->nuisance.terms.size(); ++i) {
    const NuisanceTerm& term = data_->nuisance.terms[i];
    if (term.kind != NuisanceTerm::Kind::kKnownEffect) continue;
    RobotEffect& effect = robot.effects[term.effect];
    const PhysicalRange range = physical_range(effect.kind, term.parameter);
    double& value = effect.parameters[term.parameter];
    value += factor_of_known(*data_, terms_, fit, i) * fit.nuisance[static_cast<Index>(i)];
    value = std::clamp(value, range.min, range.max);
    effect.fitted = true;
    effect.source = request_.source;
  }
  for (const std::size_t i : drives_.refitted) {
    RobotEffect& effect = robot.effects[i];
    if (effect.of_motor) continue;
    const std::size_t width = width_of(effect.kind);
    if (width >= info_of(effect.kind)->parameters.size()) continue;
    const Index joint = followed_joint(effect);
    if (std::find(widths_.begin(), widths_.end(), joint) == widths_.end()) continue;
    effect.parameters[width] = sign_width[joint];
  }
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    if (is_nothing(terms_[i], fit.coefficients[i])) continue;
    const double factor = factor_of_term(*data_, terms_, fit, i);
    RobotEffect effect{terms_[i].effect->effect(terms_[i].joint, factor * fit.coefficients[i],
                                                terms_[i].shape, sign_width)};
    effect.fitted = true;
    effect.source = request_.source;
    robot.effects.push_back(std::move(effect));
  }
}

RobotDescription InertialFit::identified() const {
  RobotDescription robot = file_;
  put_links(robot);
  robot.blanks.clear();
  put_drives(robot);
  return robot;
}

}  // namespace offnominal::desk
