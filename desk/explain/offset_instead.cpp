#include "explain/offset_instead.hpp"

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

// The numbers with which `effect` is a constant, but for their size; none where it never is.
std::optional<VectorXd> as_offset(const MatrixXd& effect, const MatrixXd& offset) {
  constexpr double kLeft = 0.1;
  const VectorXd numbers = effect.colPivHouseholderQr().solve(offset.col(0));
  if (!((effect * numbers - offset.col(0)).norm() < kLeft * offset.norm())) return std::nullopt;
  return numbers;
}

bool is_found(const FoundModel& found, const Term& term) {
  return std::any_of(found.accepted.begin(), found.accepted.end(), [&](const Accepted& one) {
    return one.term.effect == term.effect && one.term.joint == term.joint;
  });
}

// The offset that an effect may be as well; none where its size tells it from one.
std::optional<Term> offset_in(const Data& data, const FoundModel& found, const Term& term,
                              const std::vector<LinearPart>& size) {
  constexpr double kTold = 1;
  if (term.effect->is_mass() || columns_of(data, term).cols() < 2) return std::nullopt;
  Term offset = first_on_grid(data, EffectKind::kTorqueOffset, term.joint);
  if (is_found(found, offset) || !is_nested(data, found.baseline, offset, term))
    return std::nullopt;
  const auto line = as_offset(columns_of(data, term), columns_of(data, offset));
  if (!line) return std::nullopt;
  const bool told = std::all_of(size.begin(), size.end(), [&](const LinearPart& one) {
    return one.from_line(*line) >= kTold;
  });
  if (told) return std::nullopt;
  return offset;
}

}  // namespace

bool replace_by_offset(const SearchSetting& setting, const Sizes& sizes, int threads,
                       FoundModel& found) {
  const Search& search = *setting.search;
  for (std::size_t i = 0; i < found.accepted.size(); ++i) {
    const auto offset = offset_in(*setting.data, found, found.accepted[i].term, sizes.linear[i]);
    if (!offset) continue;
    std::vector<Term> terms = found.terms_without(i);
    const ModelFit without = setting.regression->fit(terms);
    terms.push_back(*offset);
    const Proposal proposal = search.proposal_of(std::move(terms), found.accepted.size() - 1);
    if (!proposal.physical) continue;
    const double p = search.family_p(proposal, without);
    if (p > search.options().family_error) {
      leave_out(i, *setting.regression, *setting.hold_out, threads, found);
      return true;
    }
    found.accepted[i] = {*offset, p, found.accepted[i].p_replay};
    order_and_hold_out(*setting.regression, *setting.hold_out, threads, found);
    return true;
  }
  return false;
}

}  // namespace offnominal::desk
