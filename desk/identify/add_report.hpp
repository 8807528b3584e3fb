#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "identify/add.hpp"
#include "report/page.hpp"

namespace offnominal::desk {

// What was fitted, as the user named it.
struct AddNames {
  std::vector<std::string> logs;
  std::vector<std::string> holdout;  // empty: parts of the logs themselves
  std::string robot_file;
  std::string output_file;
  std::string command_line;
  bool force = false;  // doubts are overruled
};

// What became of the error on data that the fit has not seen, in a sentence or two, or why the
// result must not be used.
std::string judgement_of(const AddResult& result, const AddRequest& request);
// The same, and that the result is not written, where it is not.
std::string verdict_of(const AddResult& result, const AddRequest& request, bool force = false);
report::Level level_of(const AddResult& result, const AddRequest& request);

// {effect, joint, parameters: {name: {value, unit, ci95, fitted}}, also: [{effect, joint,
//  parameters}], before: {fit: {relative_error_percent, rms_error}, holdout: {...}}, after: {...},
//  unit, holdout: {kind, logs}, recordings: [{log, held_out, joints: [{joint, unit, before,
//  after}]}], refitted: [{effect, joint, parameters}], links: [{link, factor, ci95}], notes,
//  objections, doubts, written, filter, verdict}. ci95 is [low, high], null where
// there is none, and why_no_ci95 then says why; before and after are of the joint that was asked
// for, or of those that the motor moves of the one whose error falls most; written is null where
// nothing was.
nlohmann::ordered_json to_json(const AddResult& result, const AddRequest& request,
                               const AddNames& names);

// The same for people, with a line break at its end.
std::string text_of(const AddResult& result, const AddRequest& request, const AddNames& names);

report::Page page_of(const AddResult& result, const AddRequest& request, const AddNames& names);

}  // namespace offnominal::desk
