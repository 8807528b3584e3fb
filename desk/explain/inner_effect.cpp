#include "explain/inner_effect.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "explain/alternatives.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Without a shape: where one is searched, the larger one's says where.
bool is_plain(const EffectCandidate& effect, const Data& data, Index joint) {
  return effect.spectrum() == EffectCandidate::Spectrum::kNone && !effect.is_mass() &&
         effect.applies_in_any(data.recordings, joint) &&
         effect.shapes(data.recordings, joint).empty();
}

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

std::optional<Term> inner_of(const Data& data, const FoundModel& found, const Term& outer,
                             const std::vector<LinearPart>& size) {
  constexpr double kTold = 1;
  if (outer.effect->is_mass() || columns_of(data, outer).cols() < 2) return std::nullopt;
  for (const auto& effect : all_candidates()) {
    const Term inner{effect.get(), outer.joint, {}};
    if (!is_plain(*effect, data, outer.joint) || is_found(found, inner)) continue;
    if (columns_of(data, inner).cols() != 1 || !is_nested(data, found.baseline, inner, outer)) {
      continue;
    }
    const auto line = as_inner(columns_of(data, outer), columns_of(data, inner));
    const bool told = !line || std::all_of(size.begin(), size.end(), [&](const LinearPart& one) {
      return one.from_line(*line) >= kTold;
    });
    if (!told) return inner;
  }
  return std::nullopt;
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
