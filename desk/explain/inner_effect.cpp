#include "explain/inner_effect.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "explain/alternatives.hpp"
#include "explain/friction_family.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// The numbers with which `outer` is `inner`, but for their size; none where it never is.
std::optional<VectorXd> as_inner(const MatrixXd& outer, const MatrixXd& inner) {
  constexpr double kLeft = 0.1;
  const VectorXd numbers = outer.colPivHouseholderQr().solve(inner.col(0));
  if (!((outer * numbers - inner.col(0)).norm() < kLeft * inner.norm())) return std::nullopt;
  return numbers;
}

bool is_found(const FoundModel& found, const Term& term) {
  return std::any_of(found.accepted.begin(), found.accepted.end(), [&](const Accepted& one) {
    return one.term.effect == term.effect && one.term.joint == term.joint;
  });
}

// The offset that an effect may be as well; none where its size tells it from one.
std::optional<Term> inner_of(const Data& data, const FoundModel& found, const Term& outer,
                             const std::vector<LinearPart>& size) {
  constexpr double kTold = 1;
  if (outer.effect->is_mass() || columns_of(data, outer).cols() < 2) return std::nullopt;
  Term inner = first_on_grid(data, EffectKind::kTorqueOffset, outer.joint);
  if (is_found(found, inner) || !is_nested(data, found.baseline, inner, outer)) return std::nullopt;
  const auto line = as_inner(columns_of(data, outer), columns_of(data, inner));
  if (!line) return std::nullopt;
  const bool told = std::all_of(size.begin(), size.end(), [&](const LinearPart& one) {
    return one.from_line(*line) >= kTold;
  });
  if (told) return std::nullopt;
  return inner;
}

}  // namespace

bool replace_by_inner(const SearchSetting& setting, const Sizes& sizes, int threads,
                      FoundModel& found) {
  const Search& search = *setting.search;
  for (std::size_t i = 0; i < found.accepted.size(); ++i) {
    const auto inner = inner_of(*setting.data, found, found.accepted[i].term, sizes.linear[i]);
    if (!inner) continue;
    std::vector<Term> terms = found.terms_without(i);
    const ModelFit without = setting.regression->fit(terms);
    terms.push_back(*inner);
    const Proposal proposal = search.proposal_of(std::move(terms), found.accepted.size() - 1);
    if (!proposal.physical) continue;
    const double p = search.family_p(proposal, without);
    if (p > search.options().family_error) {
      leave_out(i, *setting.regression, *setting.hold_out, threads, found);
      return true;
    }
    found.accepted[i] = {*inner, p, found.accepted[i].p_replay};
    order_and_hold_out(*setting.regression, *setting.hold_out, threads, found);
    return true;
  }
  return false;
}

}  // namespace offnominal::desk
