// What a better model with its bound is worth: the smallest loss of mass detected before and after.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "paper/sweep.hpp"
#include "report/page.hpp"

namespace offnominal::desk::paper {

struct SweepPair {
  std::string before_robot;  // as the user named it
  SweepResult before;
  std::string after_robot;
  SweepResult after;
};

[[nodiscard]] std::string words_of(const SweepPair& pair);

/// before: {robot, ...sweep}, after: {robot, ...sweep}, verdict.
[[nodiscard]] nlohmann::ordered_json to_json(const SweepPair& pair);

[[nodiscard]] report::Page page_of(const SweepPair& pair, const std::string& command_line);

}  // namespace offnominal::desk::paper
