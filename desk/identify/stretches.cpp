#include "identify/stretches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/data.hpp"
#include "log/part_of.hpp"

namespace offnominal::desk {

using Eigen::Index;

namespace {

// Filtered samples of all joints together.
constexpr double kMostRows = 30'000;
constexpr double kStretchS = 30;
constexpr double kMarginS = 2;

bool counts_time(const RobotEffect& effect) { return info_of(effect.kind)->traits.counts_time; }

}  // namespace

Log Stretch::cut() const { return part_of(*log, {first, first + samples - 1}); }

std::vector<Stretch> stretches_of(const std::vector<Log>& logs, const RobotDescription& robot,
                                  const FilterPlan& plan) {
  double whole_s = 0;
  bool at_rest = false;
  std::vector<Stretch> stretches;
  for (const Log& log : logs) {
    at_rest = at_rest || log.at_rest;
    whole_s += static_cast<double>(log.sample_count()) * log.period_s;
    stretches.push_back({&log, 0, log.sample_count(), 0});
  }
  const double bearable_s = kMostRows / static_cast<double>(robot.joint_count()) * plan.period_s();
  const double share = bearable_s / whole_s;
  // Readings at rest are few, and belong to positions, not to times.
  if (at_rest || share >= 1 ||
      std::any_of(robot.effects.begin(), robot.effects.end(), counts_time)) {
    return stretches;
  }
  stretches.clear();
  for (const Log& log : logs) {
    const double log_s = static_cast<double>(log.sample_count()) * log.period_s;
    const auto length = static_cast<Index>(std::lround((kStretchS + 2 * kMarginS) / log.period_s));
    const auto count = std::max<Index>(1, std::lround(share * log_s / kStretchS));
    const Index apart = log.sample_count() / count;
    if (apart <= length) {
      stretches.push_back({&log, 0, log.sample_count(), 0});
      continue;
    }
    for (Index i = 0; i < count; ++i) {
      const auto margin = static_cast<Index>(std::lround(kMarginS / log.period_s));
      stretches.push_back({&log, i * apart + (apart - length) / 2, length, margin});
    }
  }
  return stretches;
}

std::vector<Workspace> searched_workspaces(const std::vector<Stretch>& stretches,
                                           const RobotDescription& robot, const FilterPlan& plan,
                                           const Eigen::VectorXd& sign_width) {
  std::vector<Workspace> made;
  for (const Stretch& stretch : stretches) {
    FilterPlan own = plan_for(*stretch.log, plan);
    own.edge_samples = std::max(own.edge_samples, stretch.margin);
    if (stretch.is_whole()) {
      made.push_back(make_workspace(*stretch.log, robot, own, sign_width));
      continue;
    }
    made.push_back(make_workspace(stretch.cut(), robot, own, sign_width));
    made.back().start_s = stretch.log->t_s[0];
  }
  return made;
}

std::string words_of(const std::vector<Stretch>& stretches, const std::vector<Log>& logs) {
  double whole_s = 0;
  double searched_s = 0;
  for (const Log& log : logs) whole_s += static_cast<double>(log.sample_count()) * log.period_s;
  for (const Stretch& one : stretches) {
    searched_s += static_cast<double>(one.samples - 2 * one.margin) * one.log->period_s;
  }
  if (std::all_of(stretches.begin(), stretches.end(),
                  [](const Stretch& one) { return one.is_whole(); })) {
    return {};
  }
  return fmt::format(
      "of {:.0f} s, {:.0f} s were searched, in stretches that lie evenly over the recordings; to "
      "have another part searched, give a recording of that part alone",
      whole_s, searched_s);
}

}  // namespace offnominal::desk
