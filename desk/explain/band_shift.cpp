#include "explain/band_shift.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "identify/estimates.hpp"
#include "identify/torque_scale.hpp"

namespace offnominal::desk {

namespace {

constexpr std::array<double, 2> kBands{0.7, 0.45};  // of the band that was fitted in

std::vector<NamedValue> numbers_of(const Data& data, const std::vector<Term>& terms,
                                   const ModelFit& fit, std::size_t i) {
  const Term& term = terms[i];
  const double factor = factor_of_term(data, terms, fit, i);
  return term.effect->parameters(data.recordings[0].joint_type(term.joint),
                                 factor * fit.coefficients[i], term.shape);
}

// The same terms fitted in a band of that share of the first one.
struct NarrowFit {
  std::vector<std::vector<NamedValue>> numbers;
  std::vector<Eigen::VectorXd> linear;
};

NarrowFit fitted_in(double share, const Relinearised& fitted) {
  std::vector<Workspace> recordings = fitted.data->recordings;
  for (Workspace& at : recordings) at.plan.torque_cutoff_hz *= share;
  RobotDescription robot = recordings[0].rigid;
  robot.effects = recordings[0].known_effects;
  const Data narrow(std::move(recordings), robot, fitted.nuisance);
  const Regression regression(narrow);
  std::vector<Term> terms = fitted.terms;
  for (std::size_t i = 0; i < terms.size(); ++i) regression.refine(terms, i);
  const ModelFit fit = regression.fit(terms);
  NarrowFit result;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    result.linear.push_back(linear_numbers(terms[i], fit.coefficients[i]));
    result.numbers.push_back(numbers_of(narrow, terms, fit, i));
  }
  return result;
}

}  // namespace

std::vector<BandShift> shifts_in_narrower_bands(const Relinearised& fitted) {
  std::vector<std::vector<NamedValue>> whole;
  std::vector<BandShift> shifts;
  for (std::size_t i = 0; i < fitted.terms.size(); ++i) {
    whole.push_back(numbers_of(*fitted.data, fitted.terms, fitted.fit, i));
    shifts.push_back({std::vector<double>(whole[i].size(), 0.0), {}});
  }
  // Readings at rest have no band.
  if (fitted.data->recordings[0].at_rest) return shifts;
  for (const double share : kBands) {
    const NarrowFit narrow = fitted_in(share, fitted);
    for (std::size_t i = 0; i < shifts.size(); ++i) {
      shifts[i].linear.emplace_back(narrow.linear[i] -
                                    linear_numbers(fitted.terms[i], fitted.fit.coefficients[i]));
      std::vector<double>& largest = shifts[i].numbers;
      for (std::size_t p = 0; p < largest.size(); ++p) {
        const double moved = std::abs(narrow.numbers[i][p].value - whole[i][p].value);
        if (std::isfinite(moved)) largest[p] = std::max(largest[p], moved);
      }
    }
  }
  return shifts;
}

}  // namespace offnominal::desk
