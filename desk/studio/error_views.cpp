#include "studio/error_views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "common/effort_name.hpp"
#include "common/plain_words.hpp"
#include "common/refused.hpp"
#include "compare/error_map.hpp"
#include "compare/error_spectrum.hpp"
#include "compare/torque_charts.hpp"

namespace offnominal::desk::studio {

using Eigen::Index;
using Eigen::VectorXd;
using report::Chart;
using report::Series;
using report::Tone;

namespace {

constexpr std::size_t kMostOnCard = 2000;  // of a picture on a card

// NaN where the joint is not judged: at rest, or where the recording is at fault.
VectorXd error_of(const Comparison& one, std::size_t joint) {
  const auto column = static_cast<Index>(joint);
  const double none = std::numeric_limits<double>::quiet_NaN();
  return (one.moving.col(column).array() > 0)
      .select(one.measured.col(column) - one.model.col(column), none);
}

// The same with its mean there: no sine is made of that.
VectorXd error_without_gaps(const Comparison& one, std::size_t joint) {
  VectorXd error = error_of(one, joint);
  double sum = 0;
  Index count = 0;
  for (const double value : error) {
    if (std::isnan(value)) continue;
    sum += value;
    ++count;
  }
  const double mean = count > 0 ? sum / static_cast<double>(count) : 0;
  for (double& value : error) {
    if (std::isnan(value)) value = mean;
  }
  return error;
}

report::Axis error_axis(const Comparison& one, std::size_t joint) {
  const std::string& unit = one.joints[joint].unit;
  return {fmt::format("{} error", effort_name(unit)), unit};
}

std::string words_of(const Comparison& one, const Shown& shown) {
  if (shown.count == one.t_s.size()) return fmt::format("Of {}.", one.file);
  if (shown.count == 0) return fmt::format("Of {}: no sample in the time that is shown.", one.file);
  return fmt::format("Of {}, {:.2f} to {:.2f} s.", one.file, one.t_s[shown.first],
                     one.t_s[shown.first + shown.count - 1]);
}

Spectrum spectrum(const Comparison& one, const View& view, SpectrumOver over) {
  const Shown shown = shown_of(one, view);
  const auto part = [&](const VectorXd& values) -> VectorXd {
    return values.segment(shown.first, shown.count);
  };
  const VectorXd error = part(error_without_gaps(one, view.joint));
  // At rest there is no filter, and no time.
  const double most_hz = std::min(one.plan.torque_cutoff_hz, one.plan.sample_rate_hz / 2);
  if (over == SpectrumOver::kFrequency) return spectrum_over_time(part(one.t_s), error, most_hz);
  constexpr double kTurn = 6.283185307179586;
  const double per_unit = one.joints[view.joint].unit == "N" ? 1 : 1 / kTurn;
  const VectorXd turns = per_unit * part(one.q.col(static_cast<Index>(view.joint)));
  return spectrum_over_travel(part(one.t_s), turns, error, most_hz);
}

Series line(const std::string& name, Tone tone, Spectrum spectrum) {
  Series series;
  series.name = name;
  series.tone = tone;
  series.x = std::move(spectrum.at);
  series.y = std::move(spectrum.amplitude);
  return series;
}

report::Axis axis_of(const Comparison& one, std::size_t joint, SpectrumOver over) {
  if (over == SpectrumOver::kFrequency) return {"frequency", "Hz"};
  const bool slides = one.joints[joint].unit == "N";
  return slides ? report::Axis{"waves per metre", "1/m"} : report::Axis{"order, per turn", "1"};
}

// Of all samples of the fitted recordings.
struct Samples {
  VectorXd at;
  VectorXd error;   // without the effect
  VectorXd torque;  // the effect's
};

Samples samples_of(const Compared& without, const Compared& with, std::size_t joint,
                   const ErrorOver& over) {
  std::vector<double> at;
  std::vector<double> error;
  std::vector<double> torque;
  const auto append = [](std::vector<double>& to, const VectorXd& values) {
    to.insert(to.end(), values.begin(), values.end());
  };
  const auto column = static_cast<Index>(joint);
  for (std::size_t r = 0; r < with.fitted.recordings.size(); ++r) {
    const Comparison& bare = without.fitted.recordings[r];
    append(at, values_of(bare, over));
    append(error, error_of(bare, joint));
    append(torque, with.fitted.recordings[r].model.col(column) - bare.model.col(column));
  }
  const auto vector = [](const std::vector<double>& values) -> VectorXd {
    return Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
  };
  return {vector(at), vector(error), vector(torque)};
}

// What the effect is a function of, or else the variable of its joint that says most of it.
ErrorVariable variable_of(const Compared& without, const Compared& with, const RobotEffect& effect,
                          std::size_t shown_on) {
  switch (info_of(effect.kind)->traits.follows) {
    case EffectVariable::kPosition:
      return ErrorVariable::kPosition;
    case EffectVariable::kVelocity:
      return ErrorVariable::kVelocity;
    case EffectVariable::kLoad:
      return ErrorVariable::kLoad;
    case EffectVariable::kNone:
      break;
  }
  ErrorVariable best = ErrorVariable::kVelocity;
  double most = -1;
  for (const ErrorVariable variable : {ErrorVariable::kVelocity, ErrorVariable::kPosition,
                                       ErrorVariable::kAcceleration, ErrorVariable::kLoad}) {
    const Samples samples = samples_of(without, with, shown_on, {variable, effect.joint});
    const double share = share_explained(samples.at, samples.torque);
    if (share <= most) continue;
    most = share;
    best = variable;
  }
  return best;
}

// A mass shows on every joint that carries it: the one whose error it changes by the largest share.
std::size_t joint_changed(const Compared& without, const Compared& with,
                          const RobotEffect& effect) {
  std::size_t joint = effect.joint;
  double most = 0;
  for (std::size_t j = 0; j < without.fitted.joints.size(); ++j) {
    double changed = 0;
    double error = 0;
    for (std::size_t r = 0; r < with.fitted.recordings.size(); ++r) {
      const Comparison& bare = without.fitted.recordings[r];
      const auto column = static_cast<Index>(j);
      changed +=
          (with.fitted.recordings[r].model.col(column) - bare.model.col(column)).squaredNorm();
      error += error_without_gaps(bare, j).squaredNorm();
    }
    if (!(error > 0) || changed / error <= most) continue;
    most = changed / error;
    joint = j;
  }
  return joint;
}

}  // namespace

nlohmann::json map_of(const Workbench& bench, const Compared& now, const View& view,
                      const ErrorOver& x, const ErrorOver& y) {
  check(bench, view);
  if (std::max(x.joint, y.joint) >= bench.robot().joints.size()) {
    throw Refused(Refused::Why::kBadRequest, "There is no such joint.");
  }
  const Comparison& one = recording_of(now, view.recording);
  const Shown shown = shown_of(one, view);
  const auto side = [&](const ErrorOver& over) -> MapSide {
    return {desk::axis_of(one, over, view.joint),
            values_of(one, over).segment(shown.first, shown.count)};
  };
  const MapSide error{error_axis(one, view.joint),
                      error_of(one, view.joint).segment(shown.first, shown.count)};
  report::Heatmap map = mean_map(fmt::format("Joint {}: mean error, model now", view.joint + 1),
                                 side(x), side(y), error);
  map.note = words_of(one, shown);
  return block_of(std::move(map));
}

nlohmann::json spectrum_of(const Workbench& bench, const Compared& now, const View& view,
                           SpectrumOver over) {
  check(bench, view);
  const Comparison& one = recording_of(now, view.recording);
  const Role& role = role_of(bench, view.recording);
  Chart chart;
  chart.title = fmt::format("Joint {}: spectrum of the error", view.joint + 1);
  chart.x = axis_of(one, view.joint, over);
  chart.y = {error_axis(one, view.joint)};
  chart.y[0].name = "amplitude";
  chart.y[0].min = 0;
  chart.width = report::Width::kHalf;
  if (!bench.steps().empty()) {
    const Comparison& start = recording_of(bench.start(), view.recording);
    chart.series.push_back(line("error as read", Tone::kFaint, spectrum(start, view, over)));
  }
  chart.series.push_back(
      line(std::string("error now, ") + role.name, role.tone, spectrum(one, view, over)));
  chart.note = words_of(one, shown_of(one, view));
  if (chart.series.back().x.empty()) {
    // A chart has to have a point.
    for (Series& series : chart.series) series.x = series.y = {0};
    chart.note += !(one.plan.sample_rate_hz > 0) ? " Readings at rest have no spectrum."
                  : over == SpectrumOver::kOrder ? " The joint turns too little to tell orders."
                                                 : " Too short to tell frequencies.";
  } else {
    chart.note +=
        fmt::format(" Low-passed at {:.3g} Hz, as all errors here.", one.plan.torque_cutoff_hz);
  }
  return block_of(std::move(chart));
}

nlohmann::json evidence_of(const Compared& without, const Compared& with,
                           const RobotEffect& effect) {
  const std::size_t shown_on = joint_changed(without, with, effect);
  const ErrorOver over{variable_of(without, with, effect, shown_on), effect.joint};
  const Samples samples = samples_of(without, with, shown_on, over);
  const Comparison& any = without.fitted.recordings.front();
  Chart chart;
  chart.x = desk::axis_of(any, over, shown_on);
  chart.y = {error_axis(any, shown_on)};
  chart.title =
      fmt::format("Joint {}: error without {}", shown_on + 1, in_words(info_of(effect.kind)->name));
  chart.width = report::Width::kHalf;
  chart.max_points = kMostOnCard;
  chart.series = {
      points_of("error without it", Tone::kFaint, samples.at, samples.error),
      points_of("torque of the effect", Tone::kResidual, samples.at, samples.torque),
      binned_mean("error without it, mean of bins", Tone::kThreshold, samples.at, samples.error)};
  return block_of(std::move(chart));
}

}  // namespace offnominal::desk::studio
