#include "explain/sizes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "explain/band_shift.hpp"

namespace offnominal::desk {

using Eigen::VectorXd;

namespace {

bool is_positive(const Term& term, const std::string& parameter) {
  return std::any_of(term.ranges.begin(), term.ranges.end(), [&](const ShapeRange& range) {
    return range.name == parameter &&
           (range.is_positive() || range.name == effects::kSmoothing.name);
  });
}

// A wave whose order or frequency may as well be half of it, or none, repeats with nothing.
bool repeats_with_something(const Term& term, const std::vector<Estimate>& numbers) {
  constexpr double kHalf = 0.5;
  if (term.effect->spectrum() == EffectCandidate::Spectrum::kNone) return true;
  return std::none_of(numbers.begin(), numbers.end(), [&](const Estimate& one) {
    const bool is_searched =
        std::any_of(term.ranges.begin(), term.ranges.end(),
                    [&](const ShapeRange& range) { return range.name == one.value.name; });
    return is_searched && one.ci95 &&
           (*one.ci95)[1] - (*one.ci95)[0] > 2 * kHalf * std::abs(one.value.value);
  });
}

// What a robot file says of a number of an effect; null: it is none of the file's.
const ParameterInfo* parameter_of(const Term& term, const Estimate& number) {
  const auto& parameters = term.effect->info().parameters;
  const auto of =
      std::find_if(parameters.begin(), parameters.end(),
                   [&](const ParameterInfo& info) { return info.name == number.value.name; });
  return of == parameters.end() ? nullptr : &*of;
}

// Whether no part of what a number may be is within what a robot file takes: no such effect exists.
bool is_beyond_any(const Term& term, const std::vector<Estimate>& numbers) {
  return std::any_of(numbers.begin(), numbers.end(), [&](const Estimate& one) {
    const ParameterInfo* of = parameter_of(term, one);
    if (of == nullptr) return false;
    const double low = one.ci95 ? (*one.ci95)[0] : one.value.value;
    const double high = one.ci95 ? (*one.ci95)[1] : one.value.value;
    return high < of->min || low > of->max;
  });
}

void widen(Estimate& estimate, double deviation) {
  constexpr double kTwoSided95 = 1.96;
  if (!estimate.ci95) return;
  const double noise = ((*estimate.ci95)[1] - (*estimate.ci95)[0]) / 2;
  const double half = std::hypot(noise, kTwoSided95 * deviation);
  estimate.ci95 = {estimate.value.value - half, estimate.value.value + half};
}

// Whether some number that an effect is linear in is told from nothing by its own interval. Where
// it has several that go together none may be, though all of them at once are: what that is of is
// not known then.
bool has_a_number(const Term& term, const std::vector<Estimate>& numbers) {
  // A wave has a size, whatever its phase.
  if (term.effect->spectrum() != EffectCandidate::Spectrum::kNone) return true;
  int linear = 0;
  const bool any = std::any_of(numbers.begin(), numbers.end(), [&](const Estimate& one) {
    const ParameterInfo* of = parameter_of(term, one);
    if (of == nullptr || of->role != ParameterRole::kLinear) return false;
    ++linear;
    return !one.ci95 || (*one.ci95)[0] > 0 || (*one.ci95)[1] < 0;
  });
  return any || linear < 2;
}

}  // namespace

Sizes sizes_of(const ImprovedRobot& improved) {
  const std::vector<Term>& terms = improved.last.terms;
  if (terms.empty()) return {};
  Estimates estimates = estimates_of(improved);
  const std::vector<BandShift> shifts = shifts_in_narrower_bands(improved.last);
  Sizes sizes;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    for (std::size_t p = 0; p < estimates.terms[i].size(); ++p) {
      Estimate& one = estimates.terms[i][p];
      widen(one, shifts[i].numbers[p]);
      if (one.ci95 && is_positive(terms[i], one.value.name)) {
        (*one.ci95)[0] = std::max(0.0, (*one.ci95)[0]);
      }
    }
    // What the search took, and what clearly cannot be once all is fitted together, is no size.
    constexpr double kBarely = 0.9;
    const VectorXd& value = improved.last.fit.coefficients[i];
    const auto& recordings = improved.last.data->recordings;
    const bool possible =
        (can_be(terms[i], value, recordings) || can_be(terms[i], kBarely * value, recordings)) &&
        repeats_with_something(terms[i], estimates.terms[i]) &&
        has_a_number(terms[i], estimates.terms[i]) && !is_beyond_any(terms[i], estimates.terms[i]);
    std::vector<LinearPart> linear{estimates.linear[i]};
    for (const VectorXd& shift : shifts[i].linear) {
      linear.push_back(estimates.linear[i]);
      linear.back().widen(shift);
    }
    double least = possible ? std::numeric_limits<double>::infinity() : 0;
    for (const LinearPart& one : linear) least = std::min(least, one.from_nothing());
    sizes.linear.push_back(std::move(linear));
    sizes.from_nothing.push_back(least);
  }
  sizes.numbers = std::move(estimates.terms);
  return sizes;
}

void leave_out(std::size_t which, const Regression& regression, const HoldOut& hold_out,
               int threads, FoundModel& found) {
  const auto goes = found.accepted.begin() + static_cast<std::ptrdiff_t>(which);
  found.unsure[static_cast<std::size_t>(goes->term.joint)] = 1;
  if (found.accepted.size() == 1) {
    const RowLayout& layout = regression.data().layout;
    const Fall fall =
        best_fall(layout.rms(found.baseline.residual), layout.rms(found.fit.residual));
    found.suspected = {goes->term, goes->p, std::max(0.0, fall.share)};
  }
  found.accepted.erase(goes);
  order_and_hold_out(regression, hold_out, threads, found);
}

bool leave_out_unsure(const Sizes& sizes, const Regression& regression, const HoldOut& hold_out,
                      int threads, FoundModel& found) {
  // Significance was asked before; what these intervals hold more than noise is what the model
  // adapts, and a size that they do not tell from nothing is none. Of friction that every drive has
  // half of that is enough.
  // A transmission that gives way looks like links' inertia that grows with frequency: beside links
  // that are off it takes twice as much.
  constexpr double kSure = 1;
  constexpr double kSureOfFriction = 0.5;
  constexpr double kSureBesideLinks = 2;
  const auto& nuisance = regression.data().nuisance.terms;
  const bool links_are_off = std::any_of(nuisance.begin(), nuisance.end(), [](const auto& one) {
    return one.kind == NuisanceTerm::Kind::kLinkCentre;
  });
  std::size_t which = found.accepted.size();
  double least = 1;
  for (std::size_t i = 0; i < found.accepted.size(); ++i) {
    const EffectCandidate& effect = *found.accepted[i].term.effect;
    const double needed = effect.info().traits.every_drive_has  ? kSureOfFriction
                          : effect.gives_way() && links_are_off ? kSureBesideLinks
                                                                : kSure;
    const double reached = sizes.from_nothing[i] / needed;
    if (reached >= least) continue;
    least = reached;
    which = i;
  }
  if (which == found.accepted.size()) return false;
  leave_out(which, regression, hold_out, threads, found);
  return true;
}

}  // namespace offnominal::desk
