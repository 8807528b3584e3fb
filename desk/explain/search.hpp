#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/effect_candidate.hpp"
#include "identify/evidence.hpp"
#include "identify/regression.hpp"

namespace offnominal::desk {

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
};

// A model with one more term, or a few of one family, fitted anew as a whole.
struct Proposal {
  std::vector<Term> terms;  // the new ones last
  std::size_t added = 1;    // how many are new
  ModelFit fit;
  double score = 0;  // log-likelihood less the price of the new terms' parameters
  bool physical = false;
};

// How much evidence for anything a search shows where there is nothing more to find.
struct NullOfSearch {
  std::vector<double> largest;  // -log10 p, sorted, one per draw
  // The same of Coulomb and viscous friction alone, where the file has neither on a joint: a
  // question asked first has an error of its own. Empty: there is no such joint.
  std::vector<double> of_friction;
  std::vector<RowLayout::Blocks> blocks;  // per joint: what its errors are independent between
  double spectral_points = 0;             // of all spectra together
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
  [[nodiscard]] const Data& data() const { return data_; }
  // Every candidate that is not in `terms`, each at its best shape, best score first.
  [[nodiscard]] Screening screen(const std::vector<Term>& terms, const ModelFit& at) const;
  // The most promising candidates of a screening, `most` of them, each refined and fitted together
  // with all that the model fits: best first. Only what is physical.
  [[nodiscard]] std::vector<Proposal> propose(const std::vector<Term>& terms, const ModelFit& at,
                                              const Screening& screening,
                                              std::size_t most = kShortlist) const;
  // The same for every joint by itself; what does not come near the best of its joint is left out.
  [[nodiscard]] std::vector<std::vector<Proposal>> propose_per_joint(
      const std::vector<Term>& terms, const ModelFit& at, const Screening& screening,
      const std::vector<char>& joints) const;
  // A proposal of these terms, those from `first_new` on being new.
  [[nodiscard]] Proposal proposal_of(std::vector<Term> terms, std::size_t first_new) const;
  // Sets the proposals' scores, all by the same number of independent samples: that of the model
  // that leaves the least. Best first.
  void rank(std::vector<Proposal>& proposals) const;
  // What a search shows beside a model that lacks nothing: what it leaves is taken for the noise.
  // `at`: the model before the last of the terms were added.
  [[nodiscard]] NullOfSearch null_of(const std::vector<Term>& terms, const ModelFit& fit,
                                     const ModelFit& at) const;
  // Probability that a search as this one shows as much evidence for anything where there is
  // nothing. `at`: the model without the term.
  [[nodiscard]] double family_p(const Term& term, const ModelFit& at,
                                const NullOfSearch& null) const;
  // Friction that every drive has and the file has not: a little damping is no answer for the rest.
  [[nodiscard]] bool is_asked_first(const Term& term) const;
  // The same of a proposal of one term, what it leaves being taken for the noise.
  [[nodiscard]] double family_p(const Proposal& proposal, const ModelFit& at) const;
  // Where a term's shape is looked for; for a spectrum the peaks are not among them.
  [[nodiscard]] static std::vector<ShapePoint> grid_of(const Term& term);

 private:
  struct Slot {
    Term term;
    std::vector<ShapePoint> grid;
    std::vector<ActingColumns> columns;  // at the grid's points; empty for spectra
  };
  [[nodiscard]] bool is_worth_a_name(const Term& term, const Eigen::VectorXd& coefficients) const;
  [[nodiscard]] bool is_known(const EffectCandidate& effect, Eigen::Index joint) const;
  [[nodiscard]] bool can_show(const Term& term) const;
  [[nodiscard]] bool is_open(const Slot& slot, const std::vector<Term>& terms) const;
  [[nodiscard]] Screened judge_slot(const Slot& slot, const Remainder& at,
                                    const Judge& judge) const;
  [[nodiscard]] std::vector<Proposal> fitted(const std::vector<Term>& terms, const ModelFit& at,
                                             const std::vector<const Screened*>& shortlist) const;
  void finish(Screened& screened, const Remainder& at) const;

  const Regression& regression_;
  const Data& data_;
  SearchOptions options_;
  std::vector<Slot> slots_;
  std::vector<char> moves_;  // per joint
};

}  // namespace offnominal::desk
