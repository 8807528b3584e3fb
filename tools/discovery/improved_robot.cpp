#include "discovery/improved_robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "analysis/friction_power.hpp"
#include "analysis/physical_range.hpp"
#include "common/error.hpp"
#include "discovery/torque_scale.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::tools::discovery {

using Eigen::Index;

namespace {

// Why no robot file can have it; empty where one can.
std::string why_unwritable(const Effect<double>& effect, JointType type) {
  const EffectInfo& info = *info_of(effect.kind);
  if (!chain_may_have(effect.kind)) {
    return fmt::format("robot files and controllers do not know {} yet", info.name);
  }
  for (std::size_t i = 0; i < info.parameters.size(); ++i) {
    const ParameterInfo& parameter = info.parameters[i];
    const double value = effect.parameters[i];
    if (value >= parameter.min && value <= parameter.max) continue;
    const std::string unit = unit_of(parameter.quantity, type);
    const bool low = value < parameter.min;
    return fmt::format(
        "{} of joint {}: {} = {:.4g}{}, and {} {:g} is possible; look at the units "
        "that [channels] gives the torque",
        info.name, effect.joint + 1, parameter.name, value, unit == "1" ? "" : " " + unit,
        low ? "at least" : "at most", low ? parameter.min : parameter.max);
  }
  return {};
}

// `column`: of the nuisance; `beyond`: how far the number would be outside of its range.
HeldNumber held_number(const Relinearised& found, Index column, double asked, double beyond,
                       const PhysicalRange& range) {
  const Data& data = *found.data;
  const NuisanceTerm& term = data.nuisance.terms[static_cast<std::size_t>(column)];
  const double rms =
      std::abs(beyond) * data.layout.rms(data.nuisance.columns.col(column))[term.joint];
  HeldNumber held;
  // What is fitted beside the findings has no interval of its own.
  held.contradicted =
      contradicts(range, std::nullopt, rms / data.layout.rms(data.torque)[term.joint]);
  held.words = fmt::format(
      "{} was held at {:g}, as {} is possible; free it would be {:.4g}: {}", term.name,
      range.nearest(asked), range.words_at(asked), asked,
      held.contradicted ? range.usual_cause() : "as good as the end for these recordings");
  return held;
}

// A number of the file that is fitted beside the findings.
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
    if (!effect.fitted) continue;
    Moved moved{term.effect, term.parameter, physical_range(effect.kind, term.parameter)};
    moved.factor = factor_beside_torque_scale(found.terms, found.fit, term.joint, effect.kind);
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

// The last fit: numbers of the file that would be beyond what is possible are held at the end of
// it, and all else is fitted beside them.
Relinearised fitted_within(const RobotDescription& file, const RobotDescription& robot,
                           const Data& data, NuisanceOptions options,
                           const std::vector<Term>& terms, std::vector<HeldNumber>& held) {
  constexpr double kRounding = 1e-9;
  for (;;) {
    const Data plain(data.recordings, robot, options);
    Relinearised last = relinearise(robot, plain, options, terms, Regression(plain).fit(terms));
    const std::size_t held_before = options.known.size();
    for (const Moved& moved : moved_numbers(last, file)) {
      const bool is_held =
          std::any_of(options.known.begin(), options.known.end(), [&](const KnownNumber& one) {
            return one.effect == moved.effect && one.parameter == moved.parameter;
          });
      if (is_held || moved.range.holds(moved.asked)) continue;
      const double end = moved.range.nearest(moved.asked);
      const double beyond = (moved.asked - end) / moved.factor;
      held.push_back(held_number(last, column_of(last, moved), moved.asked, beyond, moved.range));
      const double start = file.effects[moved.effect].parameters[moved.parameter];
      const double at_end = (end - start) / moved.factor;
      const double wide = kRounding * std::max(std::abs(at_end), std::abs(beyond));
      options.known.push_back({moved.effect, moved.parameter, at_end - wide, at_end + wide});
    }
    if (options.known.size() == held_before) return last;
  }
}

void move_fitted_effects(const Relinearised& found, const std::string& source,
                         RobotDescription& robot) {
  for (const Moved& moved : moved_numbers(found, robot)) {
    RobotEffect& effect = robot.effects[moved.effect];
    // Held ones are at their end but for rounding, and for what the torque scale still moved.
    effect.parameters[moved.parameter] = std::clamp(moved.asked, moved.range.min, moved.range.max);
    effect.source = source;
  }
}

// What physics forbids of the numbers that come out of the last fit, whatever the search saw.
std::vector<std::string> unphysical(const Relinearised& last, const RobotDescription& improved) {
  std::vector<std::string> objections;
  std::set<Index> joints;
  for (std::size_t i = 0; i < last.terms.size(); ++i) {
    const Term& term = last.terms[i];
    if (!chain_may_have(term.effect->kind())) continue;
    if (is_friction(term.effect->kind())) joints.insert(term.joint);
    if (term.effect->is_physical(last.fit.coefficients[i])) continue;
    objections.push_back(fmt::format(
        "{} of joint {} came out as {:.4g}, which cannot be, once all was fitted together",
        term.effect->name(), term.joint + 1, last.fit.coefficients[i][0]));
  }
  for (const Moved& moved : moved_numbers(last, improved)) {
    const RobotEffect& effect = improved.effects[moved.effect];
    if (is_friction(effect.kind)) joints.insert(effect.joint);
  }
  const Eigen::VectorXd rms = last.data->layout.rms(last.data->torque);
  for (const Index joint : joints) {
    for (const Workspace& at : last.data->recordings) {
      const auto drives =
          friction_that_drives(improved, static_cast<std::size_t>(joint), at.motion, rms[joint]);
      if (!drives) continue;
      objections.push_back(drives->words(improved));
      break;
    }
  }
  return objections;
}

void scale_links(const Relinearised& found, const std::string& source, RobotDescription& robot) {
  robot = with_link_factors(std::move(robot), found.link_factors);
  for (std::size_t link = 0; link < found.link_factors.size(); ++link) {
    if (found.link_factors[link] == 1) continue;
    std::string& of_link = robot.joints[link].source;
    if (!of_link.empty()) of_link += " ";
    of_link += fmt::format("Mass and inertia times {:.6g}: {}", found.link_factors[link], source);
  }
}

}  // namespace

ImprovedRobot improved_robot(const RobotDescription& file, const RobotDescription& robot,
                             const Data& data, const NuisanceOptions& options,
                             const Relinearised& found, const std::string& source) {
  // What is the recordings' own, their skew and how friction builds up at a reversal, is fitted
  // beside it: left out, it would stand in the numbers that are written.
  NuisanceOptions of_links = options;
  if (std::all_of(found.link_factors.begin(), found.link_factors.end(),
                  [](double factor) { return std::abs(factor - 1) < kWorthWriting; })) {
    of_links.link_share = 0;
  }
  ImprovedRobot improved{file, {}, {}, {}};
  const Relinearised last = fitted_within(file, robot, data, of_links, found.terms, improved.held);
  scale_links(last, source, improved.robot);
  move_fitted_effects(last, source, improved.robot);
  for (std::size_t i = 0; i < last.terms.size(); ++i) {
    const Term& term = last.terms[i];
    const double factor =
        factor_beside_torque_scale(last.terms, last.fit, term.joint, term.effect->kind());
    RobotEffect effect{term.effect->effect(term.joint, factor * last.fit.coefficients[i],
                                           term.shape, data.recordings[0].sign_width)};
    std::string why =
        why_unwritable(effect, file.joints[static_cast<std::size_t>(term.joint)].joint.type);
    if (!why.empty()) {
      improved.unwritable.push_back(std::move(why));
      continue;
    }
    effect.fitted = true;
    effect.source = source;
    improved.robot.effects.push_back(std::move(effect));
  }
  improved.unphysical = unphysical(last, improved.robot);
  // As whoever reads it will judge it: a mass that is taken away may leave none.
  try {
    static_cast<void>(parse_robot(robot_text(improved.robot), "the robot with it"));
  } catch (const InputError& error) {
    improved.unwritable.emplace_back(error.what());
  }
  return improved;
}

}  // namespace offnominal::tools::discovery
