#include "discovery/improved_robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "analysis/physical_range.hpp"
#include "discovery/torque_scale.hpp"

namespace offnominal::tools::discovery {

using Eigen::Index;

namespace {

const EffectInfo* info_named(std::string_view name) {
  const auto found = std::find_if(kAllEffectInfos.begin(), kAllEffectInfos.end(),
                                  [&](const EffectInfo& info) { return name == info.name; });
  return found == kAllEffectInfos.end() ? nullptr : &*found;
}

// `sign_width`: of the smoothed sign that the regressors have where it is not a shape of theirs.
std::optional<RobotEffect> robot_effect(const Term& term, const Eigen::VectorXd& coefficients,
                                        JointType type, double sign_width) {
  const EffectInfo* info = info_named(term.effect->name());
  if (info == nullptr) return std::nullopt;
  RobotEffect effect;
  effect.kind = info->kind;
  effect.joint = static_cast<std::uint8_t>(term.joint);
  effect.fitted = true;
  std::vector<NamedValue> values =
      term.effect->parameters(type, coefficients, term.shape, term.ranges);
  values.push_back({effects::kSmoothing.name, sign_width, ""});
  for (std::size_t i = 0; i < info->parameters.size(); ++i) {
    const ParameterInfo& parameter = info->parameters[i];
    const auto value = std::find_if(values.begin(), values.end(), [&](const NamedValue& one) {
      return one.name == parameter.name;
    });
    if (value == values.end() && parameter.required) return std::nullopt;
    effect.parameters[i] = value == values.end() ? parameter.default_value : value->value;
  }
  return parameters_valid(effect) ? std::optional(effect) : std::nullopt;
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

void move_fitted_effects(const Relinearised& found, const std::string& source,
                         ImprovedRobot& improved) {
  RobotDescription& robot = improved.robot;
  for (std::size_t i = 0; i < found.data->nuisance.terms.size(); ++i) {
    const NuisanceTerm& term = found.data->nuisance.terms[i];
    if (term.kind != NuisanceTerm::Kind::kKnownEffect) continue;
    RobotEffect& effect = robot.effects[term.effect];
    if (!effect.fitted) continue;
    const PhysicalRange range = physical_range(effect.kind, term.parameter);
    double& value = effect.parameters[term.parameter];
    const double factor =
        factor_beside_torque_scale(found.terms, found.fit, term.joint, info_of(effect.kind)->name);
    const double by = factor * found.fit.nuisance[static_cast<Index>(i)];
    const double asked = value + by;
    value = std::clamp(asked, range.min, range.max);
    if (!range.holds(asked)) {
      improved.held.push_back(
          held_number(found, static_cast<Index>(i), asked, (asked - value) / factor, range));
    }
    effect.source = source;
  }
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
  const Data plain(data.recordings, robot, of_links);
  const Relinearised last =
      relinearise(robot, plain, of_links, found.terms, Regression(plain).fit(found.terms));
  ImprovedRobot improved{file, {}, {}};
  scale_links(last, source, improved.robot);
  move_fitted_effects(last, source, improved);
  for (std::size_t i = 0; i < last.terms.size(); ++i) {
    const Term& term = last.terms[i];
    const JointType type = file.joints[static_cast<std::size_t>(term.joint)].joint.type;
    const double factor =
        factor_beside_torque_scale(last.terms, last.fit, term.joint, term.effect->name());
    std::optional<RobotEffect> effect = robot_effect(term, factor * last.fit.coefficients[i], type,
                                                     data.recordings[0].sign_width[term.joint]);
    if (!effect) {
      improved.not_in_robot_files.emplace_back(term.effect->name());
      continue;
    }
    effect->source = source;
    improved.robot.effects.push_back(std::move(*effect));
  }
  return improved;
}

}  // namespace offnominal::tools::discovery
