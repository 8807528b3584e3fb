#include "command/fault_free.hpp"

#include <fmt/format.h>

#include <map>
#include <set>
#include <utility>

#include "calibrate/split.hpp"
#include "command/doctor.hpp"
#include "common/amount.hpp"
#include "common/error.hpp"
#include "common/nearest.hpp"
#include "log/part_of.hpp"
#include "robot/effect_text.hpp"

namespace offnominal::desk {
namespace {

constexpr double kShortestS = 2;

// The monitor starts anew behind what is left out, and its effects in time would too.
void refuse_late_start(const RobotDescription& robot, const Log& log) {
  for (const RobotEffect& effect : robot.effects) {
    if (!info_of(effect.kind)->traits.counts_time) continue;
    throw InputError({log.file, "", "faults of the recording, which are left out",
                      fmt::format("none but at its end, as {} of {} counts from its start",
                                  info_of(effect.kind)->name, place_of(effect)),
                      "record anew, or say with --keep JOINT:REASON what is no fault"});
  }
}

std::vector<Log> parts_left_of(const RobotDescription& robot, const std::vector<Log>& logs) {
  std::vector<Log> parts;
  for (const Log& log : logs) {
    for (Log& part : untouched_parts(log, kShortestS)) {
      if (part.t_s[0] != log.t_s[0]) refuse_late_start(robot, log);
      parts.push_back(std::move(part));
    }
    if (!parts.empty() && parts.back().file == log.file) continue;
    std::set<Eigen::Index> stretches;  // each joint's are listed
    for (const LeftOut& out : log.left_out) stretches.insert(out.rows.first);
    throw InputError(
        {log.file, "",
         fmt::format("{} left out, and no {:g} s between what is left out",
                     counted(stretches.size(), "stretch", "stretches"), kShortestS),
         fmt::format("a part of {:g} s or more without a fault of the recording", kShortestS),
         "record anew, or say with --keep JOINT:REASON what is no fault"});
  }
  return parts;
}

double seconds_of(const std::vector<Log>& logs) {
  double seconds = 0;
  for (const Log& log : logs) seconds += static_cast<double>(log.sample_count()) * log.period_s;
  return seconds;
}

// What the examination took of the recordings to calibrate on, of which `parts` are left; empty:
// nothing.
std::string left_out_words(double recorded_s, const std::vector<Log>& parts,
                           const std::vector<DataFault>& faults) {
  struct Taken {
    std::size_t stretches = 0;
    Eigen::Index rows = 0;
  };
  std::map<std::string, Taken> reasons;
  for (const DataFault& fault : faults) {
    if (fault.left_out_of.empty()) continue;
    Taken& taken = reasons[name_of(fault.kind)];
    for (const FaultSpan& span : fault.spans) {
      ++taken.stretches;
      taken.rows += span.samples.count();
    }
  }
  if (reasons.empty()) return {};
  const auto words = [](const auto& reason) {
    return fmt::format("{} of {} in {}",
                       counted(static_cast<std::size_t>(reason.second.rows), "row"), reason.first,
                       counted(reason.second.stretches, "stretch", "stretches"));
  };
  return fmt::format(
      "of {:.4g} s recorded {:.4g} s are left, in {} of {:g} s or more between what "
      "is left out ({})",
      recorded_s, seconds_of(parts), counted(parts.size(), "part"), kShortestS,
      list_of(reasons, words));
}

}  // namespace

FaultFree keep_fault_free(FitData& data, const std::vector<KeepFault>& keep, Progress& progress) {
  FaultFree kept;
  kept.faults =
      treated({data.logs, data.holdout}, data.robot, keep, progress, RestsOn::kVelocityToo);
  const double recorded_s = seconds_of(data.logs);
  for (std::vector<Log>* group : {&data.logs, &data.holdout}) {
    *group = parts_left_of(data.robot, *group);
  }
  kept.left_out = left_out_words(recorded_s, data.logs, kept.faults);
  if (data.holdout.empty()) data.holdout = take_held_out(data.logs, kShortestS);
  return kept;
}

}  // namespace offnominal::desk
