// The paper's figures 8 to 15 as a report page.
#pragma once

#include <string>
#include <vector>

#include "paper/paper_runs.hpp"
#include "report/page.hpp"

namespace offnominal::desk::paper {

/// Everything: verdict, table beside the paper's figures, figures 8 to 15, sweep.
[[nodiscard]] report::Page page_of(const PaperRuns& runs, const std::vector<Comparison>& lines,
                                   const std::string& verdict, const std::string& command_line);

/// One recorded run: verdict in words, its numbers, joint angles, fault and estimate, filtered
/// sizes.
[[nodiscard]] report::Page page_of(const ExperimentResult& run, const std::string& command_line);

/// What happened in a run, in one sentence.
[[nodiscard]] std::string words_of(const ExperimentResult& run);

}  // namespace offnominal::desk::paper
