#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "inertial/identify.hpp"
#include "report/page.hpp"

namespace offnominal::desk {

// What was identified, as the user named it.
struct IdentifyNames {
  std::vector<std::string> logs;
  std::vector<std::string> holdout;
  std::string robot_file;
  std::string output_file;  // empty: none was asked for
  std::string command_line;
  bool force = false;  // doubts are overruled
};

// How many of the numbers the recordings determine and what became of the error, or the payload;
// why nothing is written, where nothing is.
std::string verdict_of(const Identification& result, const IdentifyNames& names);
report::Level level_of(const Identification& result);

// {robot, logs, holdout: {kind, logs}, joints: [{joint, unit, moves, before, after: {fit, holdout:
//  {relative_error_percent, rms_error}}}], links: [{link, mass, centre_of_mass: [x, y, z],
//  inertia_kg_m2: {...}}], drives: [{joint, effect, parameter, ..., written}], base_parameters:
//  [...], determined, condition_number, link_share, payload, standing, notes, objections, doubts,
//  written, filter, verdict}. A number is {name, unit, before, value, ci95, determined}; before is
//  null where
// the file has none, ci95 [low, high] or null, and why_no_ci95 then says why. payload is null
// unless it was asked for.
nlohmann::ordered_json to_json(const Identification& result, const IdentifyNames& names);

// The same for people, with a line break at its end.
std::string text_of(const Identification& result, const IdentifyNames& names);

report::Page page_of(const Identification& result, const IdentifyNames& names);

// The identified robot as a file's text, with what was done and the error before and after as
// comments.
std::string robot_text_of(const Identification& result, const IdentifyNames& names);

}  // namespace offnominal::desk
