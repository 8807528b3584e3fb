// Everything that section 5 of the paper shows, and how it compares with what is printed there.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "paper/experiment.hpp"
#include "paper/sweep.hpp"

namespace offnominal::desk::paper {

struct PaperRuns {
  ExperimentResult healthy;
  ExperimentResult mass_loss;               // section 5.1, figures 8 to 10
  ExperimentResult nonlinear;               // section 5.2, figures 11 to 13
  ExperimentResult mass_loss_accommodated;  // section 5.3, figure 14
  ExperimentResult nonlinear_accommodated;  // figure 15
  SweepResult sweep;                        // end of section 5.1
};

/// Called before each part with its name.
using OnPart = std::function<void(const std::string& part)>;

/// Runs them all. `base` gives the fault's time, rate and loss, the precision and the duration; its
/// kind of fault and `accommodate` are chosen here. The single runs are recorded. Throws as
/// run_experiment().
[[nodiscard]] PaperRuns run_everything(const RobotDescription& robot, const Experiment& base,
                                       const OnPart& on_part = {});

/// One line of the table: the paper's figure beside ours, both ready to be read.
struct Comparison {
  std::string what;
  std::string paper;
  std::string here;
  std::optional<bool> agrees;  // none: the paper's words give nothing to measure against
};

/// The paper's claims, each with what these runs gave and whether the two agree: detection within
/// 0.1 s (figure 9) and 0.2 s (figure 12), 10 % detected and 7.5 % not, the network silent before
/// the fault, |theta| <= M. "Considerably
/// reduced" by accommodation is taken as at least halved.
[[nodiscard]] std::vector<Comparison> compare_with_paper(const PaperRuns& runs);

/// One sentence over all lines. `paper_settings` tells whether the runs used the paper's settings,
/// without which a difference is no contradiction.
[[nodiscard]] std::string verdict_of(const std::vector<Comparison>& lines, bool paper_settings);

}  // namespace offnominal::desk::paper
