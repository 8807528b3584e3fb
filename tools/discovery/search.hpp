#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "discovery/effect_candidate.hpp"
#include "discovery/evidence.hpp"
#include "discovery/regression.hpp"

namespace offnominal::tools::discovery {

// A candidate at its best shape beside a model.
struct Screened {
  Term term;
  Evidence evidence;
  double score = 0;    // log-likelihood less the price of its parameters
  double log10_p = 0;  // -log10 of its own p-value
  // Its coefficients have the sign that physics asks for, and are beyond what the nuisance adapts.
  bool physical = false;
};

struct Screening {
  std::vector<Screened> candidates;
  std::vector<Evidence> groups;  // every point of every grid, spectra left out
  int blocks = 0;
  double spectral_points = 0;  // of all spectra together
};

// A model with one more term, fitted anew as a whole.
struct Proposal {
  Screened candidate;
  std::vector<Term> terms;  // the new one last
  ModelFit fit;
  double score = 0;  // log-likelihood less the price of the new term's parameters
  bool physical = false;
};

struct SearchOptions {
  double family_error = 0.01;
  int bootstrap_draws = 1999;
  std::uint64_t seed = 1;
  int threads = 1;
};

// Looks for the term that a model lacks. The regression has to outlive it.
class Search {
 public:
  Search(const Regression& regression, const SearchOptions& options);

  static constexpr std::size_t kShortlist = 10;

  [[nodiscard]] const SearchOptions& options() const { return options_; }
  // Every candidate that is not in `terms`, each at its best shape, best score first.
  [[nodiscard]] Screening screen(const std::vector<Term>& terms, const ModelFit& at) const;
  // The most promising candidates of a screening, `most` of them, each refined and fitted together
  // with all that the model fits: best first. Only what is physical.
  [[nodiscard]] std::vector<Proposal> propose(const std::vector<Term>& terms, const ModelFit& at,
                                              const Screening& screening,
                                              std::size_t most = kShortlist) const;
  // Probability that a search as this one shows as much evidence for anything where there is
  // nothing: what the proposal leaves is taken for the noise. `at`: the model without it.
  [[nodiscard]] double family_p(const Proposal& proposal, const ModelFit& at) const;
  // Where a term's shape is looked for; for a spectrum the peaks are not among them.
  [[nodiscard]] static std::vector<ShapePoint> grid_of(const Term& term);

 private:
  struct Slot {
    Term term;
    std::vector<ShapePoint> grid;
    std::vector<Eigen::MatrixXd> columns;  // at the grid's points; empty for spectra
  };
  void rank(std::vector<Proposal>& proposals) const;
  [[nodiscard]] bool is_worth_a_name(const Term& term, const Eigen::VectorXd& coefficients) const;
  [[nodiscard]] bool is_known(const EffectCandidate& effect, Eigen::Index joint) const;
  [[nodiscard]] Screened judge_slot(const Slot& slot, const Remainder& at,
                                    std::vector<Evidence>& all) const;
  void finish(Screened& screened, const Remainder& at) const;

  const Regression& regression_;
  const Data& data_;
  SearchOptions options_;
  std::vector<Slot> slots_;
};

}  // namespace offnominal::tools::discovery
