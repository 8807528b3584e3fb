#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "calibrate/calibrate.hpp"
#include "report/page.hpp"

namespace offnominal::desk {

/// How the robot file and the result are called in what is shown.
struct CalibrateNames {
  std::string robot;
  std::string output;
  std::string command_line;
};

/// A bound in one line of words: "scaled_norm: 4.4 (|[[2, -6]] dq| + 1) rad/s^2".
[[nodiscard]] std::string words_of(const BoundSettings& bound, const std::string& unit);

/// The result in one sentence or two.
[[nodiscard]] std::string verdict_of(const Calibration& calibration);

/// Why the result must not be used, and what a reader has to know of it: at the head of a page, and
/// as lines of a text.
void add_remarks(const std::vector<std::string>& notes, const std::vector<std::string>& objections,
                 report::Section& section);
[[nodiscard]] std::string remarks_text(const std::vector<std::string>& notes,
                                       const std::vector<std::string>& objections);

[[nodiscard]] std::string text_of(const Calibration& calibration, const CalibrateNames& names);
[[nodiscard]] nlohmann::ordered_json to_json(const Calibration& calibration,
                                             const CalibrateNames& names);
[[nodiscard]] report::Page page_of(const Calibration& calibration, const CalibrateNames& names);

}  // namespace offnominal::desk
