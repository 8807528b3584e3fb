#include "identify/add.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <set>
#include <utility>

#include "common/nearest.hpp"
#include "identify/add_doubts.hpp"
#include "identify/add_setup.hpp"
#include "identify/estimates.hpp"
#include "identify/friction_power.hpp"
#include "identify/held_out_errors.hpp"
#include "identify/improved_robot.hpp"
#include "identify/indistinct.hpp"
#include "identify/lookalike.hpp"
#include "identify/physical_range.hpp"
#include "identify/shape_search.hpp"
#include "identify/sign_width.hpp"
#include "identify/stretches.hpp"
#include "log/seen_by_sensor.hpp"
#include "robot/effect_text.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

class Adder {
 public:
  Adder(const RobotDescription& file, const AddRequest& request, FitMemory& memory,
        const OnProgress& on_progress)
      : file_(file),
        robot_(file),
        request_(request),
        memory_(memory),
        holdout_(memory.holdout()),
        on_progress_(on_progress),
        setup_(set_up(file, request)) {
    for (const std::vector<Log>* some : {&memory.logs(), &memory.holdout()}) {
      for (const Log& log : *some) require_joints(log, file_);
    }
    // What is believed of a link is two standard deviations wide.
    nuisance_.link_share = 2 * request.inertia_deviation.value_or(0);
    nuisance_.free_effects = setup_.refitted;
    if (!request.fit_skew) nuisance_.skew_samples = 0;
    const VectorXd& resolved = memory_.sign_widths(file_);
    std::vector<Workspace> recordings = memory_.workspaces(robot_, resolved);
    settle_sign_widths(resolved, robot_, recordings);
    data_ = std::make_unique<Data>(std::move(recordings), memory_.inertial(), robot_, nuisance_);
    regression_ = std::make_unique<Regression>(*data_);
    terms_ = terms_of(setup_, request.joint, *data_);
  }

  AddResult run() {
    fit_shapes(*regression_, terms_, on_progress_);
    hold_what_is_indistinct();
    improve();
    take_numbers();
    judge();
    object();
    note();
    return std::move(result_);
  }

 private:
  [[nodiscard]] Unknown unknown_of(const ModelNumber& number) const {
    Unknown unknown;
    if (number.of == ModelNumber::Of::kTerm) {
      const Term& term = terms_[number.which];
      unknown.effect = number.which;  // place() makes an index of it
      unknown.parameter = parameter_of_coefficient(*term.effect, number.coefficient);
      unknown.joint = static_cast<std::size_t>(term.joint);
      unknown.is_new = true;
      return unknown;
    }
    const NuisanceTerm& term = data_->nuisance.terms[number.which];
    unknown.joint = static_cast<std::size_t>(term.joint);
    if (term.kind == NuisanceTerm::Kind::kLink) {
      unknown.kind = Unknown::Kind::kLinkScale;
      return unknown;
    }
    unknown.effect = term.effect;
    unknown.parameter = term.parameter;
    return unknown;
  }

  // Of the robot file, or to be.
  [[nodiscard]] bool is_of_the_file(const ModelNumber& number) const {
    if (number.of == ModelNumber::Of::kTerm) return true;
    const NuisanceTerm::Kind kind = data_->nuisance.terms[number.which].kind;
    return kind == NuisanceTerm::Kind::kKnownEffect || kind == NuisanceTerm::Kind::kLink;
  }

  void hold_what_is_indistinct() {
    for (;;) {
      const auto found = first_indistinct(*regression_, terms_, regression_->fit(terms_));
      if (found.empty() || !is_of_the_file(found.front().fixed)) return;
      const IndistinctNumber& one = found.front();
      Indistinct indistinct{unknown_of(one.fixed), {}};
      for (const ModelNumber& other : one.others) {
        if (is_of_the_file(other)) indistinct.others.push_back(unknown_of(other));
      }
      result_.fit.indistinct.push_back(std::move(indistinct));
      if (one.fixed.of == ModelNumber::Of::kTerm) {
        auto& given = terms_[one.fixed.which].given;
        given.resize(std::max(given.size(), one.fixed.coefficient + 1));
        given[one.fixed.coefficient] = 0;
        continue;
      }
      NuisanceTerm& term = data_->nuisance.terms[one.fixed.which];
      term.prior = Prior::at(0);
      nuisance_.known.push_back({term.effect, term.parameter, term.prior.low, term.prior.high});
    }
  }

  void improve() {
    improved_ =
        improved_robot(file_, robot_, *data_,
                       {nuisance_, setup_.refitted,
                        given_widths(setup_, request_.joint, file_.joint_count()), request_.source},
                       relinearise(robot_, *data_, nuisance_, terms_, regression_->fit(terms_)));
    result_.robot = improved_.robot;
    for (std::size_t i = 0; i < improved_.added.size(); ++i) {
      if (improved_.added[i] != kUnwritten) {
        result_.added.push_back(improved_.added[i]);
        continue;
      }
      // Shown with its numbers all the same; unwritable() says why it is not written.
      const Relinearised& last = improved_.last;
      RobotEffect effect{last.terms[i].effect->effect(last.terms[i].joint, last.fit.coefficients[i],
                                                      last.terms[i].shape,
                                                      last.data->recordings[0].sign_width)};
      effect.fitted = true;
      effect.source = request_.source;
      result_.added.push_back(result_.robot.effects.size());
      result_.robot.effects.push_back(std::move(effect));
    }
    for (Indistinct& one : result_.fit.indistinct) {
      place(one.fixed);
      for (Unknown& other : one.others) place(other);
    }
  }

  // From the number of a new effect to its place in the robot.
  void place(Unknown& unknown) const {
    if (unknown.is_new) unknown.effect = result_.added[unknown.effect];
  }

  [[nodiscard]] double value_of(std::size_t effect, std::size_t parameter) const {
    return result_.robot.effects[effect].parameters[parameter];
  }

  // An interval of what is added to a number as one of the number.
  static std::optional<Interval> counted_from(double value, const Estimate& by) {
    if (!by.ci95) return std::nullopt;
    const double half = ((*by.ci95)[1] - (*by.ci95)[0]) / 2;
    return Interval{value - half, value + half};
  }

  [[nodiscard]] bool is_indistinct(std::size_t effect, std::size_t parameter) const {
    const auto& all = result_.fit.indistinct;
    return std::any_of(all.begin(), all.end(), [&](const Indistinct& one) {
      return one.fixed.kind == Unknown::Kind::kEffectParameter && one.fixed.effect == effect &&
             one.fixed.parameter == parameter;
    });
  }

  void take_numbers() {
    const Relinearised& last = improved_.last;
    const Estimates estimates = estimates_of(improved_);
    for (std::size_t i = 0; i < last.data->nuisance.terms.size(); ++i) {
      take_nuisance(i, estimates.nuisance[i]);
    }
    for (std::size_t i = 0; i < last.terms.size(); ++i) take_term(i, estimates.terms[i]);
    for (std::size_t i = 0; i < improved_.widths.size(); ++i) {
      take_width(improved_.widths[i], estimates.widths[i]);
    }
  }

  void take_nuisance(std::size_t i, const Estimate& by) {
    const Relinearised& last = improved_.last;
    const NuisanceTerm& term = last.data->nuisance.terms[i];
    if (term.kind == NuisanceTerm::Kind::kLink) {
      const auto link = static_cast<std::size_t>(term.joint);
      const double factor = last.links[link].factor;
      result_.fit.links.push_back({link, factor, counted_from(factor, by)});
      return;
    }
    if (term.kind != NuisanceTerm::Kind::kKnownEffect) return;
    const double value = value_of(term.effect, term.parameter);
    const bool fitted = !is_indistinct(term.effect, term.parameter) && !term.prior.is_held();
    FittedParameter parameter{term.effect, term.parameter, value, std::nullopt, {}, fitted};
    if (fitted) {
      parameter.ci95 = counted_from(value, by);
      parameter.why_no_interval = by.why_no_interval;
    }
    result_.fit.parameters.push_back(std::move(parameter));
  }

  void take_term(std::size_t i, const std::vector<Estimate>& estimates) {
    const std::size_t effect = result_.added[i];
    const auto parameters = info_of(result_.robot.effects[effect].kind)->parameters;
    for (const Estimate& estimate : estimates) {
      for (std::size_t p = 0; p < parameters.size(); ++p) {
        if (estimate.value.name != parameters[p].name) continue;
        const EffectCandidate& of = *setup_.added[i].effect;
        // The width of a joint is told of all that follow it; of a motor it is the effect's own.
        if (p == width_of(of.kind()) && !of.of_motor() && !setup_.added[i].given[p]) continue;
        const bool fitted = !setup_.added[i].given[p] && !is_indistinct(effect, p);
        FittedParameter parameter{effect, p, value_of(effect, p), std::nullopt, {}, fitted};
        if (fitted) {
          parameter.ci95 = estimate.ci95;
          parameter.why_no_interval = estimate.why_no_interval;
        }
        result_.fit.parameters.push_back(std::move(parameter));
      }
    }
  }

  // The width of a joint is a number of every effect that follows it.
  void take_width(Index joint, const Estimate& by) {
    std::vector<std::size_t> effects = setup_.refitted;
    effects.insert(effects.end(), result_.added.begin(), result_.added.end());
    for (const std::size_t i : effects) {
      const RobotEffect& effect = result_.robot.effects[i];
      const std::size_t width = width_of(effect.kind);
      const bool has = width < info_of(effect.kind)->parameters.size();
      if (!has || effect.of_motor || followed_joint(effect) != joint) continue;
      FittedParameter parameter{i,   width, effect.parameters[width], by.ci95, by.why_no_interval,
                                true};
      if (parameter.ci95) (*parameter.ci95)[0] = std::max(0.0, (*parameter.ci95)[0]);
      result_.fit.parameters.push_back(std::move(parameter));
    }
  }

  // The joints whose torque any number of the fit changes.
  [[nodiscard]] std::vector<std::size_t> touched_joints() const {
    const Relinearised& last = improved_.last;
    const RowLayout& layout = last.data->layout;
    const std::vector<std::size_t> asked = joints_asked(file_, request_);
    std::set<std::size_t> joints(asked.begin(), asked.end());
    const auto touch = [&](const Eigen::Ref<const VectorXd>& column) {
      const VectorXd energy = layout.energy(column);
      for (Index joint = 0; joint < energy.size(); ++joint) {
        if (energy[joint] > 0) joints.insert(static_cast<std::size_t>(joint));
      }
    };
    for (const Term& term : last.terms) {
      const Eigen::MatrixXd columns = columns_of(*last.data, term);
      for (Index c = 0; c < columns.cols(); ++c) touch(columns.col(c));
    }
    for (std::size_t i = 0; i < last.data->nuisance.terms.size(); ++i) {
      const NuisanceTerm::Kind kind = last.data->nuisance.terms[i].kind;
      if (kind == NuisanceTerm::Kind::kKnownEffect || kind == NuisanceTerm::Kind::kLink) {
        touch(last.data->nuisance.columns.col(static_cast<Index>(i)));
      }
    }
    return {joints.begin(), joints.end()};
  }

  [[nodiscard]] std::vector<BeforeAfter> parts_held_out() const {
    const HeldOutErrors of = held_out_errors(file_, improved_, improved_.last.terms);
    std::vector<BeforeAfter> errors;
    for (const std::size_t joint : touched_joints()) {
      const auto j = static_cast<Index>(joint);
      errors.push_back({joint, result_.before.joints[joint].unit, 100 * of.before[j] / of.torque[j],
                        100 * of.after[j] / of.torque[j], of.before[j], of.after[j]});
    }
    return errors;
  }

  void judge() {
    const auto take = [&](FitMemory::Two two, bool held_out) {
      for (std::size_t i = 0; i < two.after.recordings.size(); ++i) {
        const Comparison& one = two.after.recordings[i];
        result_.recordings.push_back(
            {one.file, held_out, before_after(two.before.recordings[i], one), one.remarks});
      }
      result_.before = std::move(two.before);
      result_.after = std::move(two.after);
      return before_after(result_.before.joints, result_.after.joints);
    };
    result_.fitted_logs = take(memory_.compared(file_, result_.robot), false);
    result_.cross_validated = holdout_.empty();
    if (holdout_.empty()) {
      result_.held_out = parts_held_out();
      return;
    }
    result_.after_fitted = std::move(result_.after);
    result_.held_out = take(memory_.compared_held_out(file_, result_.robot), true);
  }

  // Share of the joint's rms torque, the largest where a motor moves several, that a number's
  // change by `by` makes.
  [[nodiscard]] double torque_share(const FittedParameter& parameter, double by) const {
    const Relinearised& last = improved_.last;
    const RowLayout& layout = last.data->layout;
    const VectorXd torque = layout.rms(last.data->torque);
    for (std::size_t i = 0; i < last.terms.size(); ++i) {
      if (result_.added[i] != parameter.effect) continue;
      const Eigen::MatrixXd columns = columns_of(*last.data, last.terms[i]);
      for (Index c = 0; c < columns.cols(); ++c) {
        if (parameter_of_coefficient(*last.terms[i].effect, static_cast<std::size_t>(c)) !=
            parameter.parameter) {
          continue;
        }
        const VectorXd rms = layout.rms(columns.col(c));
        double share = 0;
        for (const std::size_t joint : joints_asked(file_, request_)) {
          const auto j = static_cast<Index>(joint);
          if (torque[j] > 0) share = std::max(share, std::abs(by) * rms[j] / torque[j]);
        }
        return share;
      }
    }
    return 0;
  }

  void object_to_ranges() {
    for (const FittedParameter& parameter : result_.fit.parameters) {
      if (parameter.effect < file_.effects.size()) continue;  // held: improved_.held
      const EffectKind kind = result_.robot.effects[parameter.effect].kind;
      const PhysicalRange range = physical_range(kind, parameter.parameter);
      if (!parameter.fitted || range.holds(parameter.value)) continue;
      const double share =
          torque_share(parameter, parameter.value - range.nearest(parameter.value));
      const std::string cause =
          contradicts(range, parameter.ci95, share)
              ? std::string(range.usual_cause())
              : fmt::format(
                    "{:g}, the end of that, fits as well: the recording does not show this "
                    "effect",
                    range.nearest(parameter.value));
      result_.objections.push_back(
          fmt::format("{} came out as {}; {} is possible: {}", name_of(result_, parameter),
                      value_words(result_, parameter), range.words_at(parameter.value), cause));
    }
    for (const FittedLink& link : result_.fit.links) {
      if (link.factor > 0) continue;
      result_.objections.push_back(
          fmt::format("mass and inertia of link {} came out negative", link.link + 1));
    }
  }

  // The linear numbers that were to be fitted.
  [[nodiscard]] std::vector<Unknown> asked() const {
    std::vector<Unknown> all;
    for (std::size_t i = 0; i < setup_.added.size(); ++i) {
      const auto& given = setup_.added[i].given;
      for (std::size_t c = 0; c < terms_[i].given.size(); ++c) {
        Unknown unknown = unknown_of({ModelNumber::Of::kTerm, i, c});
        place(unknown);
        if (!given[unknown.parameter]) all.push_back(unknown);
      }
    }
    return all;
  }

  void object() {
    object_to_indistinct(asked(), result_);
    object_to_ranges();
    for (const HeldNumber& held : improved_.held) {
      (held.contradicted ? result_.objections : result_.notes).push_back(held.words());
    }
    // What no range of one number says. Nothing where a number is beyond its own: that says more.
    if (result_.objections.empty()) result_.objections = improved_.unphysical;
    if (result_.objections.empty()) result_.objections = improved_.unwritable;
    doubt_what_held_out_data_say(request_, result_);
    doubt_what_may_be_nothing(request_, result_);
  }

  void note() {
    note_indistinct(result_);
    const Relinearised& last = improved_.last;
    const Regression regression(*last.data);
    for (std::size_t i = 0; i < last.terms.size(); ++i) {
      for (std::size_t c = 0; c < last.terms[i].given.size(); ++c) {
        if (last.terms[i].given[c]) continue;
        Unknown fitted = unknown_of({ModelNumber::Of::kTerm, i, c});
        place(fitted);
        for (const Lookalike& other : lookalikes(regression, last.terms, i, c)) {
          result_.notes.push_back(fmt::format(
              "{} looks the same in this recording as {}.{}{}, which the model does not have",
              desk::name_of(result_.robot, fitted), other.effect->name(), other.parameter,
              last.terms[i].effect->of_motor() && !other.effect->of_motor() ? " at the joint"
                                                                            : ""));
        }
      }
    }
    if (setup_.refitted.empty()) return;
    std::vector<std::string> names;
    for (const std::size_t effect : setup_.refitted) {
      const RobotEffect& of = result_.robot.effects[effect];
      names.push_back(fmt::format("{} on {}", info_of(of.kind)->name, place_of(of)));
    }
    result_.notes.push_back("fitted again together with it: " + list_of(names));
  }

  const RobotDescription& file_;
  RobotDescription robot_;  // the same with signs as wide as the motion can resolve
  const AddRequest& request_;
  FitMemory& memory_;
  const std::vector<Log>& holdout_;
  const OnProgress& on_progress_;
  AddSetup setup_;
  NuisanceOptions nuisance_;
  std::unique_ptr<Data> data_;
  std::unique_ptr<Regression> regression_;
  std::vector<Term> terms_;
  ImprovedRobot improved_;
  AddResult result_;
};

}  // namespace

void check_sensors(const RobotDescription& robot, const AddRequest& request, const Log& log) {
  RobotDescription asked = robot;
  const bool exists =
      request.joint < robot.joints.size() && (!request.of_motor || robot.transmission);
  for (const EffectKind kind : request.effects) {
    if (!exists) break;  // which is said later
    RobotEffect effect;
    effect.kind = kind;
    effect.joint = static_cast<std::uint8_t>(request.joint);
    effect.of_motor = request.of_motor;
    asked.effects.push_back(effect);
  }
  refuse_hidden_from_sensors(asked, log);
}

std::vector<std::size_t> joints_of(const RobotDescription& robot, EffectKind kind,
                                   std::size_t joint, bool of_motor) {
  std::vector<std::size_t> joints;
  if (of_motor) {
    for (const MovedJoint& moved : joints_of_motor(robot, joint)) {
      joints.push_back(static_cast<std::size_t>(moved.joint));
    }
  } else if (info_of(kind)->action == EffectAction::kPointMass) {
    joints.resize(joint + 1);
    std::iota(joints.begin(), joints.end(), std::size_t{0});
  } else {
    joints.push_back(joint);
  }
  return joints;
}

std::vector<std::size_t> joints_asked(const RobotDescription& robot, const AddRequest& request) {
  std::set<std::size_t> joints;
  for (const EffectKind kind : request.effects) {
    const std::vector<std::size_t> own = joints_of(robot, kind, request.joint, request.of_motor);
    joints.insert(own.begin(), own.end());
  }
  return {joints.begin(), joints.end()};
}

AddResult add(const RobotDescription& robot, const AddRequest& request, FitMemory& memory,
              const OnProgress& on_progress) {
  for (const Log& log : memory.logs()) check_sensors(robot, request, log);
  for (const Log& log : memory.holdout()) check_sensors(robot, request, log);
  return Adder(robot, request, memory, on_progress).run();
}

AddResult add(const RobotDescription& robot, const AddRequest& request,
              const std::vector<Log>& logs, const std::vector<Log>& holdout,
              const FilterRequest& filter, const OnProgress& on_progress) {
  FitMemory memory(logs, holdout, filter, FitMemory::For::kOneFit);
  return add(robot, request, memory, on_progress);
}

}  // namespace offnominal::desk
