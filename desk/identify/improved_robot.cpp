#include "identify/improved_robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "common/error.hpp"
#include "identify/friction_power.hpp"
#include "identify/link_masses.hpp"
#include "identify/physical_range.hpp"
#include "identify/sign_width.hpp"
#include "identify/torque_scale.hpp"
#include "robot/effect_text.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

// Why no robot file can have it; empty where one can.
std::string why_unwritable(const Effect<double>& effect, JointType type) {
  const EffectInfo& info = *info_of(effect.kind);
  for (std::size_t i = 0; i < info.parameters.size(); ++i) {
    const ParameterInfo& parameter = info.parameters[i];
    const double value = effect.parameters[i];
    if (value >= parameter.min && value <= parameter.max) continue;
    const std::string unit = unit_of(parameter.quantity, type);
    const bool low = value < parameter.min;
    return fmt::format(
        "{} of {}: {} = {:.4g}{}, and {} {:g} is possible; look at the units "
        "that [channels] gives the torque",
        info.name, place_of(effect), parameter.name, value, unit == "1" ? "" : " " + unit,
        low ? "at least" : "at most", low ? parameter.min : parameter.max);
  }
  return {};
}

// `column`: of the nuisance; `beyond`: how far the number would be outside of its range, in the
// fit's units; `start`: what the file has. What asks for little more than the end on its way there
// from a number that is far off says that the end is right.
HeldNumber held_number(const Relinearised& found, Index column, double start, double asked,
                       double beyond, const PhysicalRange& range) {
  constexpr double kOfTheWay = 0.25;
  const Data& data = *found.data;
  const NuisanceTerm& term = data.nuisance.terms[static_cast<std::size_t>(column)];
  const double rms =
      std::abs(beyond) * data.layout.rms(data.nuisance.columns.col(column))[term.joint];
  HeldNumber held;
  held.joint = term.joint;
  // What is fitted beside the findings has no interval of its own.
  held.contradicted =
      contradicts(range, std::nullopt, rms / data.layout.rms(data.torque)[term.joint]) &&
      std::abs(asked - range.nearest(asked)) > kOfTheWay * std::abs(range.nearest(asked) - start);
  held.what = fmt::format("{} was held at {:g}, as {} is possible; free it would be {:.4g}",
                          term.name, range.nearest(asked), range.words_at(asked), asked);
  held.why = held.contradicted ? range.usual_cause() : "as good as the end for these recordings";
  return held;
}

// A number of the file that is fitted beside the findings: of the effects that get new ones.
struct Moved {
  std::size_t effect = 0;
  std::size_t parameter = 0;
  PhysicalRange range;
  double factor = 1;  // of the regression's numbers
  double asked = 0;
};

std::vector<Moved> moved_numbers(const Relinearised& found, const RobotDescription& robot) {
  std::vector<Moved> all;
  for (std::size_t i = 0; i < found.data->nuisance.terms.size(); ++i) {
    const NuisanceTerm& term = found.data->nuisance.terms[i];
    if (term.kind != NuisanceTerm::Kind::kKnownEffect) continue;
    const RobotEffect& effect = robot.effects[term.effect];
    Moved moved{term.effect, term.parameter, physical_range(effect.kind, term.parameter)};
    moved.factor = factor_of_known(*found.data, found.terms, found.fit, i);
    moved.asked = effect.parameters[term.parameter] +
                  moved.factor * found.fit.nuisance[static_cast<Index>(i)];
    all.push_back(moved);
  }
  return all;
}

// Column of a number of the file.
Index column_of(const Relinearised& found, const Moved& moved) {
  const auto& terms = found.data->nuisance.terms;
  const auto at = std::find_if(terms.begin(), terms.end(), [&](const NuisanceTerm& term) {
    return term.kind == NuisanceTerm::Kind::kKnownEffect && term.effect == moved.effect &&
           term.parameter == moved.parameter;
  });
  return static_cast<Index>(at - terms.begin());
}

// Whether a number asks for little beyond the end of its range: by no more than the file was off,
// or by little of what the joint's other numbers ask for together. `beyond`: in the fit's units.
bool asks_for_little(const Relinearised& found, const RobotDescription& file, const Moved& moved,
                     double beyond) {
  constexpr double kLittle = 0.25;  // of the root mean square of their torque
  const double end = moved.range.nearest(moved.asked);
  const double start = file.effects[moved.effect].parameters[moved.parameter];
  if (std::abs(moved.asked - end) <= std::abs(end - start)) return true;
  const Data& data = *found.data;
  const Index column = column_of(found, moved);
  const Index joint = data.nuisance.terms[static_cast<std::size_t>(column)].joint;
  VectorXd others = VectorXd::Zero(data.layout.rows());
  for (std::size_t i = 0; i < data.nuisance.terms.size(); ++i) {
    const NuisanceTerm& term = data.nuisance.terms[i];
    const auto other = static_cast<Index>(i);
    if (term.kind != NuisanceTerm::Kind::kKnownEffect || term.joint != joint || other == column) {
      continue;
    }
    others += found.fit.nuisance[other] * data.nuisance.columns.col(other);
  }
  const VectorXd own = beyond * data.nuisance.columns.col(column);
  return data.layout.rms(own)[joint] <= kLittle * data.layout.rms(others)[joint];
}

// The last fit and what it is made of.
struct FileFit {
  Relinearised last;
  RobotDescription made_with;
  std::vector<Index> widths;
};

class FileFitter {
 public:
  FileFitter(const RobotDescription& file, RobotDescription robot, const Data& data,
             NuisanceOptions nuisance, const FileFitOptions& options, std::vector<Term> terms)
      : file_(file),
        robot_(std::move(robot)),
        recordings_(data.recordings),
        nuisance_(std::move(nuisance)),
        terms_(std::move(terms)) {
    nuisance_.sign_shapes = false;
    if (recordings_[0].at_rest) return;
    VectorXd settled = settled_sign_widths(file, options.refitted);
    for (Index joint = 0; joint < options.given_widths.size(); ++joint) {
      if (options.given_widths[joint] > 0) settled[joint] = options.given_widths[joint];
    }
    for (Index joint = 0; joint < settled.size(); ++joint) {
      if (settled[joint] > 0) set_width(joint, settled[joint]);
    }
    widths_ = joints_with_free_width(file, options.refitted, terms_, settled);
    for (const Index joint : widths_) {
      const double found = searched_sign_width(terms_, joint);
      if (found > 0) set_width(joint, found);
    }
    set_model();
  }

  FileFit run(std::vector<HeldNumber>& held) {
    fit_widths();
    return {fitted_within(held), robot_, widths_};
  }

 private:
  void set_width(Index joint, double width) {
    set_sign_width(robot_, joint, width);
    for (Workspace& at : recordings_) at.sign_width[joint] = width;
    for (Term& term : terms_) hold_sign_width(term, joint, width);
  }
  void set_model() {
    for (Workspace& at : recordings_) at.set_model(robot_);
  }

  // A width and what else is fitted depend on each other: in turn.
  void fit_widths() {
    constexpr int kTurns = 2;
    for (int turn = 0; turn < kTurns && !widths_.empty(); ++turn) {
      const Data data(recordings_, robot_, nuisance_);
      const Regression regression(data);
      for (std::size_t i = 0; turn > 0 && i < terms_.size(); ++i) regression.refine(terms_, i);
      const ModelFit fit = regression.fit(terms_);
      std::vector<double> best;
      for (const Index joint : widths_) {
        best.push_back(best_sign_width(data, robot_, terms_, fit, joint));
      }
      for (std::size_t i = 0; i < widths_.size(); ++i) set_width(widths_[i], best[i]);
      set_model();
    }
  }

  // Numbers of the file that would be beyond what is possible are held at the end of it, and all
  // else is fitted beside them.
  Relinearised fitted_within(std::vector<HeldNumber>& held) {
    constexpr double kRounding = 1e-9;
    std::vector<char> near;        // per held number: asks_for_little()
    std::optional<VectorXd> free;  // what is left per joint where nothing is held
    for (;;) {
      const Data plain(recordings_, robot_, nuisance_);
      Relinearised last =
          relinearise(robot_, plain, nuisance_, terms_, Regression(plain).fit(terms_));
      if (!free) free = last.data->layout.rms(last.fit.residual);
      const std::size_t held_before = nuisance_.known.size();
      for (const Moved& moved : moved_numbers(last, file_)) {
        if (is_known(moved.effect, moved.parameter) || moved.range.holds(moved.asked)) continue;
        const double end = moved.range.nearest(moved.asked);
        const double beyond = (moved.asked - end) / moved.factor;
        const double start = file_.effects[moved.effect].parameters[moved.parameter];
        held.push_back(
            held_number(last, column_of(last, moved), start, moved.asked, beyond, moved.range));
        near.push_back(asks_for_little(last, file_, moved, beyond) ? 1 : 0);
        const double at_end = (end - start) / moved.factor;
        const double wide = kRounding * std::max(std::abs(at_end), std::abs(beyond));
        nuisance_.known.push_back({moved.effect, moved.parameter, at_end - wide, at_end + wide});
      }
      if (nuisance_.known.size() > held_before) continue;
      settle_held(last, near, *free, held);
      return last;
    }
  }

  // A number that is held, where the joint's others take most of what all of them take free: they
  // were wrong, and the end is as good as any number for it. `near`: per held number, whether it
  // asks for little beyond its end; `free`: what is left per joint where none is held, rms.
  void settle_held(const Relinearised& last, const std::vector<char>& near, const VectorXd& free,
                   std::vector<HeldNumber>& held) const {
    constexpr double kLost = 1.0 / 3;  // of the energy
    if (std::none_of(held.begin(), held.end(), [](const auto& one) { return one.contradicted; })) {
      return;
    }
    NuisanceOptions as_the_file = nuisance_;
    const Prior unmoved = Prior::at(0);
    for (const NuisanceTerm& term : last.data->nuisance.terms) {
      const bool is_other = term.kind == NuisanceTerm::Kind::kKnownEffect &&
                            holds_what_cannot_be(held, term.joint) &&
                            !is_known(term.effect, term.parameter);
      if (!is_other) continue;
      as_the_file.known.push_back({term.effect, term.parameter, unmoved.low, unmoved.high});
    }
    const Data data(recordings_, robot_, as_the_file);
    const VectorXd ends_alone = data.layout.rms(
        relinearise(robot_, data, as_the_file, terms_, Regression(data).fit(terms_)).fit.residual);
    const VectorXd within = last.data->layout.rms(last.fit.residual);
    for (std::size_t i = 0; i < held.size(); ++i) {
      HeldNumber& one = held[i];
      const Index joint = one.joint;
      const double least = free[joint] * free[joint];
      const double lost = within[joint] * within[joint] - least;
      const double all = ends_alone[joint] * ends_alone[joint] - least;
      if (!one.contradicted || near[i] == 0 || lost > kLost * all) continue;
      one.contradicted = false;
      one.why = "the joint's other numbers take most of what it takes";
    }
  }

  [[nodiscard]] bool is_known(std::size_t effect, std::size_t parameter) const {
    return std::any_of(nuisance_.known.begin(), nuisance_.known.end(), [&](const KnownNumber& one) {
      return one.effect == effect && one.parameter == parameter;
    });
  }

  const RobotDescription& file_;
  RobotDescription robot_;
  std::vector<Workspace> recordings_;
  NuisanceOptions nuisance_;
  std::vector<Term> terms_;
  std::vector<Index> widths_;
};

// "coefficient was 10, level was 0.1: Fitted to ...", behind what the file said; of what was fitted
// before the fit is the only source.
void move_fitted_effects(const Relinearised& found, const std::string& source,
                         RobotDescription& robot) {
  std::map<std::size_t, std::string> former;  // per effect
  for (const Moved& moved : moved_numbers(found, robot)) {
    RobotEffect& effect = robot.effects[moved.effect];
    // Held ones are at their end but for rounding, and for what the torque scale still moved.
    double& number = effect.parameters[moved.parameter];
    std::string& words = former[moved.effect];
    words += fmt::format("{}{} was {:g}", words.empty() ? "" : ", ",
                         info_of(effect.kind)->parameters[moved.parameter].name, number);
    number = std::clamp(moved.asked, moved.range.min, moved.range.max);
  }
  for (const auto& [index, words] : former) {
    RobotEffect& effect = robot.effects[index];
    effect.source = effect.fitted ? source
                                  : fmt::format("{}{}{}: {}", effect.source,
                                                effect.source.empty() ? "" : "; ", words, source);
    effect.fitted = true;
  }
}

// Friction that all together gives energy, whatever the search saw, of joints whose friction is not
// the file's.
std::vector<FrictionDrives> friction_that_drives(const Relinearised& last,
                                                 const RobotDescription& improved) {
  std::vector<FrictionDrives> found;
  std::set<Index> joints;
  for (const Term& term : last.terms) {
    const EffectKind kind = term.effect->kind();
    if (!term.effect->of_motor() && is_friction(kind)) joints.insert(term.joint);
  }
  for (const Moved& moved : moved_numbers(last, improved)) {
    const RobotEffect& effect = improved.effects[moved.effect];
    if (!effect.of_motor && is_friction(effect.kind)) joints.insert(effect.joint);
  }
  const Eigen::VectorXd rms = last.data->layout.rms(last.data->torque);
  for (const Index joint : joints) {
    for (const Workspace& at : last.data->recordings) {
      const auto drives = friction_that_drives(
          at.as_recorded(improved), static_cast<std::size_t>(joint), at.motion, rms[joint]);
      if (!drives) continue;
      found.push_back(*drives);
      break;
    }
  }
  return found;
}

void set_fitted_width(RobotDescription& robot, const std::vector<std::size_t>& refitted,
                      Index joint, double width) {
  for (const std::size_t i : refitted) {
    RobotEffect& effect = robot.effects[i];
    if (effect.of_motor) continue;
    const std::size_t at = width_of(effect.kind);
    if (at < info_of(effect.kind)->parameters.size() && followed_joint(effect) == joint) {
      effect.parameters[at] = width;
    }
  }
}

void scale_links(const Relinearised& found, const std::string& source, RobotDescription& robot) {
  const RobotDescription before = robot;
  robot = with_link_changes(std::move(robot), found.links);
  for (std::size_t link = 0; link < found.links.size(); ++link) {
    const LinkChange& by = found.links[link];
    if (by.largest(size_of_link(before, link)) == 0) continue;
    std::string words = fmt::format("Mass and inertia times {:.6g}", by.factor);
    if (by.inertia_factor != 1) {
      words = fmt::format("Mass times {:.6g}, inertia times {:.6g}", by.factor,
                          by.factor * by.inertia_factor);
    }
    const auto& c = by.centre_m;
    if (c[0] != 0 || c[1] != 0 || c[2] != 0) {
      words += fmt::format(", centre of mass moved by {:.4g}, {:.4g}, {:.4g} m", c[0], c[1], c[2]);
    }
    std::string& of_link = robot.joints[link].source;
    if (!of_link.empty()) of_link += of_link.ends_with('.') ? " " : ". ";
    of_link += fmt::format("{}: {}", words, source);
  }
}

// Errors of the torque constants that were fitted beside the links' numbers.
std::vector<FittedConstant> constants_of(const Relinearised& found) {
  std::vector<FittedConstant> constants;
  for (std::size_t i = 0; i < found.data->nuisance.terms.size(); ++i) {
    const NuisanceTerm& term = found.data->nuisance.terms[i];
    const double error = found.fit.nuisance[static_cast<Index>(i)];
    if (term.kind == NuisanceTerm::Kind::kConstant && error != 0) {
      constants.push_back({term.joint, error});
    }
  }
  return constants;
}

bool are_worth_writing(const std::vector<FittedConstant>& constants) {
  return std::any_of(constants.begin(), constants.end(), [](const FittedConstant& one) {
    return std::abs(one.error) >= kWorthWriting;
  });
}

// Numbers of the drives as masses are of the links.
void put_constants(const std::vector<FittedConstant>& constants, const std::string& source,
                   RobotDescription& robot) {
  for (const FittedConstant& one : constants) {
    robot.effects.push_back(
        {{EffectKind::kTorqueScale, static_cast<std::uint8_t>(one.joint), {one.error}, false},
         true,
         "Fitted beside all else: " + source});
  }
}

// Fits them about what they are, as effects from `first` on, within `share` of the file's.
void free_constants(const std::vector<FittedConstant>& constants, std::size_t first, double share,
                    NuisanceOptions& nuisance) {
  for (const FittedConstant& one : constants) {
    nuisance.known.push_back({first, 0, -share - one.error, share - one.error});
    nuisance.free_effects->push_back(first++);
  }
}

// Moves them half the way to what the fit asks for, since whole steps may go to and fro between the
// ends; whether one of them moves by more than that.
bool move_constants(const Relinearised& fitted, const RobotDescription& robot, std::size_t first,
                    double than, std::vector<FittedConstant>& constants) {
  bool moves = false;
  for (const Moved& moved : moved_numbers(fitted, robot)) {
    if (moved.effect < first || moved.effect >= first + constants.size()) continue;
    double& error = constants[moved.effect - first].error;
    const double step = (moved.asked - error) / 2;
    moves = moves || std::abs(step) > than;
    error += step;
  }
  return moves;
}

// The last fit, beside the constants that `improved` has so far. What is carried is scaled by them
// as they were: they are fitted until they stay, and all else then by what they are. Sets the
// robot, its constants and what was held.
FileFit fit_with_constants(const RobotDescription& file, const RobotDescription& robot,
                           const Data& data, const NuisanceOptions& nuisance,
                           const FileFitOptions& options, const std::vector<Term>& terms,
                           ImprovedRobot& improved) {
  constexpr int kMostTurns = 5;
  constexpr double kStays = 0.001;
  std::vector<FittedConstant>& constants = improved.constants;
  bool is_last = constants.empty();
  for (int turn = 1;; ++turn) {
    improved.robot = file;
    RobotDescription start = robot;
    put_constants(constants, options.source, improved.robot);
    put_constants(constants, options.source, start);
    NuisanceOptions free = nuisance;
    if (!is_last) {
      free_constants(constants, file.effects.size(), options.nuisance.torque_constant, free);
    }
    improved.held.clear();
    FileFitter fitter(improved.robot, std::move(start), data, std::move(free), options, terms);
    FileFit fit = fitter.run(improved.held);
    if (is_last) return fit;
    is_last = !move_constants(fit.last, improved.robot, file.effects.size(), kStays, constants) ||
              turn == kMostTurns;
  }
}

}  // namespace

bool holds_what_cannot_be(const std::vector<HeldNumber>& held, Index joint) {
  return std::any_of(held.begin(), held.end(), [joint](const HeldNumber& one) {
    return one.contradicted && one.joint == joint;
  });
}

std::vector<std::size_t> fitted_effects(const RobotDescription& robot) {
  std::vector<std::size_t> fitted;
  for (std::size_t i = 0; i < robot.effects.size(); ++i) {
    if (robot.effects[i].fitted) fitted.push_back(i);
  }
  return fitted;
}

ImprovedRobot improved_robot(const RobotDescription& file, const RobotDescription& robot,
                             const Data& data, const FileFitOptions& options, Relinearised found) {
  NuisanceOptions nuisance = options.nuisance;
  nuisance.free_effects = options.refitted;
  bool as_the_file = true;
  for (std::size_t link = 0; link < found.links.size(); ++link) {
    as_the_file =
        as_the_file && found.links[link].largest(size_of_link(file, link)) < kWorthWriting;
  }
  if (as_the_file || options.keeps_links) nuisance.link_share = 0;
  // What is carried is scaled by every joint's own: then the last fit has them as the file will, as
  // numbers of effects. Held at what the search found they would bend its mass.
  const bool carries = std::any_of(found.terms.begin(), found.terms.end(),
                                   [](const Term& one) { return one.effect->is_mass(); });
  auto constants = constants_of(found);
  if (carries || !are_worth_writing(constants)) nuisance.torque_constant = 0;
  ImprovedRobot improved;
  if (carries && are_worth_writing(constants)) {
    improved.constants = std::move(constants);
  }
  FileFit file_fit =
      fit_with_constants(file, robot, data, nuisance, options, found.terms, improved);
  improved.made_with = std::move(file_fit.made_with);
  improved.widths = std::move(file_fit.widths);
  improved.last = std::move(file_fit.last);
  const Relinearised& last = improved.last;
  if (constants = constants_of(last); !constants.empty()) {
    put_constants(constants, options.source, improved.robot);
    improved.constants = std::move(constants);
  }
  const VectorXd& sign_width = last.data->recordings[0].sign_width;
  scale_links(last, options.source, improved.robot);
  move_fitted_effects(last, options.source, improved.robot);
  for (const Index joint : improved.widths) {
    set_fitted_width(improved.robot, options.refitted, joint, sign_width[joint]);
  }
  for (std::size_t i = 0; i < last.terms.size(); ++i) {
    const Term& term = last.terms[i];
    const double factor = factor_of_term(*last.data, last.terms, last.fit, i);
    RobotEffect effect{
        term.effect->effect(term.joint, factor * last.fit.coefficients[i], term.shape, sign_width)};
    std::string why = why_unwritable(effect, file.type_of(effect));
    if (!why.empty()) {
      improved.unwritable.push_back(std::move(why));
      improved.added.push_back(kUnwritten);
      continue;
    }
    improved.added.push_back(improved.robot.effects.size());
    effect.fitted = true;
    effect.source = options.source;
    improved.robot.effects.push_back(std::move(effect));
  }
  improved.unphysical = masses_beyond_belief(file, improved.robot);
  for (const FrictionDrives& one : friction_that_drives(last, improved.robot)) {
    improved.unphysical.push_back(one.words(improved.robot));
    if (one.contradicted) improved.driven.push_back(static_cast<Index>(one.joint));
  }
  improved.found = std::move(found);
  // As whoever reads it will judge it: a mass that is taken away may leave none.
  try {
    static_cast<void>(parse_robot(robot_text(improved.robot), "the robot with it"));
  } catch (const InputError& error) {
    improved.unwritable.emplace_back(error.what());
  }
  return improved;
}

bool moves_links(const ImprovedRobot& improved) { return improved.last.nuisance.link_share > 0; }

Estimates estimates_of(const ImprovedRobot& improved) {
  const Relinearised& last = improved.last;
  Estimates estimates = estimates_of(Regression(*last.data), improved.made_with, last.terms,
                                     last.fit, improved.widths);
  const Relinearised& found = improved.found;
  const Estimates beside =
      estimates_of(Regression(*found.data), improved.made_with, found.terms, found.fit);
  for (std::size_t i = 0; i < estimates.terms.size(); ++i) {
    for (std::size_t p = 0; p < estimates.terms[i].size(); ++p) {
      Estimate& one = estimates.terms[i][p];
      const Estimate& other = beside.terms[i][p];
      if (!one.ci95 || !other.ci95) continue;
      const double noise =
          std::max((*one.ci95)[1] - (*one.ci95)[0], (*other.ci95)[1] - (*other.ci95)[0]) / 2;
      const double half = std::hypot(noise, one.value.value - other.value.value);
      one.ci95 = {one.value.value - half, one.value.value + half};
    }
    LinearPart& linear = estimates.linear[i];
    const VectorXd apart = beside.linear[i].value - linear.value;
    const bool known = linear.region.size() > 0 && beside.linear[i].region.size() > 0;
    if (!known) linear.region.resize(0, 0);
    if (known && beside.linear[i].from_nothing() < linear.from_nothing()) linear = beside.linear[i];
    linear.widen(apart);
  }
  return estimates;
}

}  // namespace offnominal::desk
