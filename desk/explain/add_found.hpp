#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "compare/before_after.hpp"
#include "explain/explain.hpp"
#include "explain/explain_report.hpp"

namespace offnominal::desk {

// What a robot's file gains from everything that was found, recording by recording.
struct Gain {
  std::string log;
  bool held_out = false;  // no fit has seen it
  std::vector<BeforeAfter> joints;
};

struct AddedFindings {
  Explanation explanation;  // `improved` is the robot to write, where nothing is objected
  std::vector<Gain> gains;
  std::vector<std::string> objections;  // why it must not be written; empty: it may
  // Why it should not be, as far as data say that the fit has not seen: for the user to overrule.
  std::vector<std::string> doubts;

  [[nodiscard]] bool may_be_written(bool overruled) const {
    return objections.empty() && (doubts.empty() || overruled);
  }
};

// Searches as explain() does and compares the robot with everything that was found to the robot as
// it was, with the filter of `offnominal compare`; on hold maps reading by reading, less the
// friction that holds by the direction of approach. Errors as of explain().
AddedFindings add_found(const RobotDescription& robot, std::vector<Log> logs,
                        std::vector<Log> holdout, const ExplainOptions& options,
                        const OnProgress& on_progress);

// {logs, holdout, robot, verdict, words, found, pushes, data_faults, data_hints, left_out and
// advice as of explain,
//  recordings: [{log, held_out, joints: [{joint, unit, rms_error_before,
//  rms_error_after, relative_error_before_percent, relative_error_after_percent}]}], objections,
//  doubts, held, written}. `written` is null where nothing was; `force`: doubts are overruled.
nlohmann::ordered_json to_json(const AddedFindings& added, const ExplainNames& names,
                               const std::string& output_file, bool force = false);

// The same for a terminal.
std::string text_of(const AddedFindings& added, const ExplainNames& names, bool force = false);

}  // namespace offnominal::desk
