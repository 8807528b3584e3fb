#include "calibrate/tightest.hpp"

#include <Clp_C_Interface.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "common/error.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;

constexpr double kRowTolerance = 1e-6;  // by which a row may be missed before it is handed over
constexpr int kMostRounds = 200;
constexpr Index kChunks = 32;  // of a part; each hands over its worst row

[[noreturn]] void refuse_programme(const std::string& found) {
  throw InputError({.file = "calibration",
                    .place = "linear programme of the bound",
                    .found = found,
                    .allowed = "",
                    .mend = "check that the recordings move and that their numbers are sane"});
}

// minimise cost * x, x >= lowest, row * x >= 1 for the rows added so far. Each row is divided by
// its error and each column by its size, so that the solver's tolerances are relative.
class Programme {
 public:
  Programme(const Eigen::VectorXd& cost, const Eigen::VectorXd& lowest)
      : model_(Clp_newModel(), &Clp_deleteModel) {
    Clp_setLogLevel(model_.get(), 0);
    const auto columns = static_cast<int>(cost.size());
    const Eigen::VectorXd upper = Eigen::VectorXd::Constant(columns, kInfinity);
    const std::vector<int> starts(static_cast<std::size_t>(columns) + 1, 0);
    Clp_addColumns(model_.get(), columns, lowest.data(), upper.data(), cost.data(), starts.data(),
                   nullptr, nullptr);
  }

  void add(const Eigen::VectorXd& row) {
    std::vector<int> columns;
    std::vector<double> values;
    for (Index k = 0; k < row.size(); ++k) {
      if (row[k] <= 0) continue;
      columns.push_back(static_cast<int>(k));
      values.push_back(row[k]);
    }
    const double lower = 1;
    const double upper = kInfinity;
    const int starts[]{0, static_cast<int>(columns.size())};
    Clp_addRows(model_.get(), 1, &lower, &upper, starts, columns.data(), values.data());
  }

  [[nodiscard]] Eigen::VectorXd solve(Index size) {
    Clp_dual(model_.get(), 0);
    // Rows of very different size can stop a dual simplex that goes on from the last basis: anew
    // then.
    if (Clp_status(model_.get()) != 0) Clp_initialPrimalSolve(model_.get());
    if (Clp_status(model_.get()) != 0) refuse_programme("no numbers that cover every sample");
    return Eigen::Map<const Eigen::VectorXd>(Clp_primalColumnSolution(model_.get()), size);
  }

 private:
  static constexpr double kInfinity = 1e30;  // the solver's own
  std::unique_ptr<Clp_Simplex, void (*)(Clp_Simplex*)> model_;
};

// Mean of the rows that count; a column that is nowhere felt costs a little all the same, so that
// it stays at its lowest.
Eigen::VectorXd mean_row(const std::vector<ThresholdRows>& parts) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(parts.front().rows.cols());
  Index count = 0;
  for (const ThresholdRows& part : parts) {
    if (!part.counts) continue;
    sum += part.rows.colwise().sum().transpose();
    count += part.rows.rows();
  }
  return sum / static_cast<double>(std::max<Index>(count, 1));
}

// Hands over the worst row of each chunk; returns by which factor the worst of all is missed.
double add_missed(const std::vector<ThresholdRows>& parts, const Eigen::VectorXd& size,
                  const Eigen::VectorXd& c, Programme& programme) {
  double worst_of_all = 0;
  for (const ThresholdRows& part : parts) {
    const Eigen::VectorXd threshold = part.rows * c;
    const Index chunk = std::max<Index>(1, (threshold.size() + kChunks - 1) / kChunks);
    for (Index begin = 0; begin < threshold.size(); begin += chunk) {
      const Index end = std::min(begin + chunk, threshold.size());
      Index worst = begin;
      double factor = 0;
      for (Index i = begin; i < end; ++i) {
        if (!(part.error[i] > 0)) continue;
        if (!(part.error[i] > factor * threshold[i])) continue;
        if (!(threshold[i] > 0)) refuse_programme("a sample with |e| > 0 and no threshold");
        worst = i;
        factor = part.error[i] / threshold[i];
      }
      if (factor > 1 + kRowTolerance) {
        programme.add((part.rows.row(worst).transpose().array() * size.array()).matrix() /
                      part.error[worst]);
      }
      worst_of_all = std::max(worst_of_all, factor);
    }
  }
  return worst_of_all;
}

}  // namespace

Eigen::VectorXd tightest(const std::vector<ThresholdRows>& parts, const Eigen::VectorXd& lowest,
                         const Eigen::VectorXd& price) {
  const Eigen::VectorXd cost = mean_row(parts);
  Eigen::VectorXd size = Eigen::VectorXd::Ones(cost.size());
  for (Index k = 0; k < cost.size(); ++k) {
    if (cost[k] > 0) size[k] = 1 / cost[k];
  }
  // In units in which every number adds the same to the mean threshold.
  const Eigen::VectorXd scaled_cost = (cost.array() * size.array()).max(1e-3) * price.array();
  Programme programme(scaled_cost, lowest.cwiseQuotient(size));
  Eigen::VectorXd c = size;
  double missed = add_missed(parts, size, c, programme);
  if (!(missed > 0)) return lowest;
  c = lowest.cwiseMax(missed * 1e-6 * size);
  for (int round = 0; round < kMostRounds; ++round) {
    missed = add_missed(parts, size, c, programme);
    if (missed <= 1 + kRowTolerance) break;
    c = programme.solve(cost.size()).cwiseProduct(size).cwiseMax(lowest);
  }
  if (!std::isfinite(missed)) refuse_programme("numbers that are not finite");
  return std::max(missed, 1.0) * c;
}

}  // namespace offnominal::desk
