#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/data.hpp"
#include "identify/evidence.hpp"
#include "identify/fit.hpp"
#include "identify/term.hpp"

namespace offnominal::desk {

// Whether a term takes the place of an unknown of the nuisance once it is in the model.
bool takes_place_of(const Term& term, const NuisanceTerm& nuisance);

// Whether one of the terms is that effect of a joint.
bool has_term(const std::vector<Term>& terms, EffectKind kind, Eigen::Index joint);
// Whether the file or one of the terms has that effect on a joint.
bool has_effect(const Data& data, const std::vector<Term>& terms, EffectKind kind,
                Eigen::Index joint);

// A model's fit to data: the nuisance and the terms.
struct ModelFit {
  Eigen::VectorXd nuisance;                   // one per nuisance term
  std::vector<Eigen::VectorXd> coefficients;  // per term
  Eigen::VectorXd residual;                   // unweighted, stacked
  Eigen::VectorXd joint_weights;
  Remainder remainder;
  double prior_weight = 1;  // fit.hpp
};

// Columns of a term on any data of the same robot.
Eigen::MatrixXd columns_of(const Data& data, const Term& term);

// The evidence for a term. The columns of a curve of any shape add up to a constant, which the
// model may have beside it: then it is judged by as many of its columns as say something new.
Evidence evidence_for(const Judge& judge, const Data& data, const Term& term);

// Fits models to data, which have to outlive it: the nuisance, and terms.
class Regression {
 public:
  explicit Regression(const Data& data) : data_(data) {}

  [[nodiscard]] const Data& data() const { return data_; }
  // Fits nuisance and terms; `rows`: weights 0 or 1 per row, empty for all.
  [[nodiscard]] ModelFit fit(const std::vector<Term>& terms,
                             const std::vector<char>& rows = {}) const;
  // The same with the weights, of joints and priors, of another fit: what that model leaves says
  // what the data are worth.
  [[nodiscard]] ModelFit fit_weighted_as(const ModelFit& like,
                                         const std::vector<Term>& terms) const;
  // What is fitted: nuisance that applies, then the terms' columns, not weighted.
  struct Design {
    Eigen::MatrixXd columns;
    std::vector<Prior> priors;
    std::vector<Eigen::Index> kept;   // nuisance terms
    std::vector<Eigen::Index> first;  // first column of every term, and one past the last
  };
  [[nodiscard]] Design design(const std::vector<Term>& terms) const;
  // Moves a term's shape to where the model fits best, the other terms as they are.
  void refine(std::vector<Term>& terms, std::size_t which) const;
  // The same where fit() of the other terms is known, and what judges beside it.
  void refine(std::vector<Term>& terms, std::size_t which, const ModelFit& beside,
              const Judge& judge) const;

 private:
  // All of a fit that follows from what least squares said with its weights; `rows` as in fit().
  void complete(ModelFit& result, const Design& made, const std::vector<Term>& terms,
                PriorFit fitted, const Eigen::VectorXd& independent_samples,
                const std::vector<char>& rows) const;
  // An unknown of the nuisance stands at one of its ends: free of it, it might not.
  [[nodiscard]] bool holds_an_end(const ModelFit& fit) const;
  [[nodiscard]] bool has_dry_friction(const std::vector<Term>& terms, Eigen::Index joint) const;

  const Data& data_;
};

}  // namespace offnominal::desk
