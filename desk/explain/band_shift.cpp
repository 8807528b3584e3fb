#include "explain/band_shift.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

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
std::vector<std::vector<NamedValue>> numbers_in(double share, const Relinearised& fitted) {
  std::vector<Workspace> recordings = fitted.data->recordings;
  for (Workspace& at : recordings) at.plan.torque_cutoff_hz *= share;
  RobotDescription robot = recordings[0].rigid;
  robot.effects = recordings[0].known_effects;
  const Data narrow(std::move(recordings), robot, fitted.nuisance);
  const Regression regression(narrow);
  std::vector<Term> terms = fitted.terms;
  for (std::size_t i = 0; i < terms.size(); ++i) regression.refine(terms, i);
  const ModelFit fit = regression.fit(terms);
  std::vector<std::vector<NamedValue>> numbers;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    numbers.push_back(numbers_of(narrow, terms, fit, i));
  }
  return numbers;
}

}  // namespace

std::vector<std::vector<double>> largest_shifts_in_narrower_bands(const Relinearised& fitted) {
  std::vector<std::vector<NamedValue>> whole;
  std::vector<std::vector<double>> shifts;
  for (std::size_t i = 0; i < fitted.terms.size(); ++i) {
    whole.push_back(numbers_of(*fitted.data, fitted.terms, fitted.fit, i));
    shifts.emplace_back(whole[i].size(), 0.0);
  }
  // Readings at rest have no band.
  if (fitted.data->recordings[0].at_rest) return shifts;
  for (const double share : kBands) {
    const auto numbers = numbers_in(share, fitted);
    for (std::size_t i = 0; i < shifts.size(); ++i) {
      for (std::size_t p = 0; p < shifts[i].size(); ++p) {
        const double moved = std::abs(numbers[i][p].value - whole[i][p].value);
        if (std::isfinite(moved)) shifts[i][p] = std::max(shifts[i][p], moved);
      }
    }
  }
  return shifts;
}

}  // namespace offnominal::desk
