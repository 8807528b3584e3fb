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
// Of a part; each hands over its worst row.
constexpr Index kChunks = 32;
constexpr Index kChunksOfStarts = 4;

[[noreturn]] void refuse_programme(const std::string& found) {
  throw InputError({.file = "calibration",
                    .place = "linear programme of the bound",
                    .found = found,
                    .allowed = "",
                    .mend = "check that the recordings move and that their numbers are sane"});
}

constexpr double kInfinity = 1e30;  // the solver's own

// minimise cost * x, highest >= x >= lowest, row * x >= 1 for the rows added so far. Each row is
// divided by its error and each column by its size, so that the solver's tolerances are relative.
class Programme {
 public:
  Programme(const Eigen::VectorXd& cost, const Eigen::VectorXd& lowest,
            const Eigen::VectorXd& highest)
      : model_(Clp_newModel(), &Clp_deleteModel) {
    Clp_setLogLevel(model_.get(), 0);
    // Clp 1.17 keeps the factors of its own scaling from before rows came, and calls optimal what
    // costs up to three times the optimum.
    Clp_scaling(model_.get(), 0);
    const auto columns = static_cast<int>(cost.size());
    const std::vector<int> starts(static_cast<std::size_t>(columns) + 1, 0);
    Clp_addColumns(model_.get(), columns, lowest.data(), highest.data(), cost.data(), starts.data(),
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
    // A millionth off what is allowed it calls impossible, and goes on from there when asked to.
    if (Clp_status(model_.get()) != 0) Clp_primal(model_.get(), 0);
    if (Clp_status(model_.get()) != 0) refuse_programme("no numbers that cover every sample");
    return Eigen::Map<const Eigen::VectorXd>(Clp_primalColumnSolution(model_.get()), size);
  }

 private:
  std::unique_ptr<Clp_Simplex, void (*)(Clp_Simplex*)> model_;
};

// Mean of the parts' own rows; a column that is nowhere felt costs a little all the same, so that
// it stays at its lowest.
Eigen::VectorXd mean_row(const ThresholdParts& parts) {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(parts.front().get().unknowns());
  Index count = 0;
  for (const ThresholdRows& part : parts) {
    mean.head(part.filtered.cols()) += part.filtered.bottomRows(part.size()).colwise().sum();
    count += part.size();
  }
  mean /= static_cast<double>(std::max<Index>(count, 1));
  const ThresholdRows& any = parts.front();
  if (any.constant > 0) mean[mean.size() - 1] = any.constant;
  return mean;
}

// The worst row of a chunk, and by which factor it is missed; 0 where nothing is.
struct Missed {
  Index row = 0;
  double factor = 0;
};
Missed worst_of(const Eigen::VectorXd& threshold, const Eigen::VectorXd& error, Index begin,
                Index end) {
  Missed worst{begin, 0};
  for (Index i = begin; i < end; ++i) {
    if (!(error[i] > 0) || !(error[i] > worst.factor * threshold[i])) continue;
    if (!(threshold[i] > 0)) refuse_programme("a sample with |e| > 0 and no threshold");
    worst = {i, error[i] / threshold[i]};
  }
  return worst;
}

// Hands over the worst row of each chunk; returns by which factor the worst of all is missed.
double add_missed(const ThresholdParts& parts, const Eigen::VectorXd& size,
                  const Eigen::VectorXd& c, Programme& programme) {
  double worst_of_all = 0;
  for (const ThresholdRows& part : parts) {
    const Eigen::VectorXd along = part.along(c);
    for (const Demand& demand : part.demands) {
      const Eigen::VectorXd threshold = part.threshold(demand.start, along, c);
      const Index chunks = demand.start.ticks == 0 ? kChunks : kChunksOfStarts;
      const Index chunk = std::max<Index>(1, (threshold.size() + chunks - 1) / chunks);
      for (Index begin = 0; begin < threshold.size(); begin += chunk) {
        const Missed worst =
            worst_of(threshold, demand.error, begin, std::min(begin + chunk, threshold.size()));
        worst_of_all = std::max(worst_of_all, worst.factor);
        if (worst.factor <= 1 + kRowTolerance) continue;
        programme.add(part.row(demand.start, worst.row).cwiseProduct(size) /
                      demand.error[worst.row]);
      }
    }
  }
  return worst_of_all;
}

}  // namespace

Eigen::VectorXd ThresholdRows::threshold(const StartBefore& start, const Eigen::VectorXd& along,
                                         const Eigen::VectorXd& c) const {
  const Index first = std::max<Index>(0, start.ticks - history);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(size());
  if (first >= size()) return result;
  const Index rows = size() - first;
  result.tail(rows) =
      along.tail(rows) - start.kept * along.segment(history + first - start.ticks, rows);
  if (constant > 0) result.tail(rows).array() += constant * c[c.size() - 1];
  if (starts_at_largest) {
    result.tail(rows).array() += start.kept * c.head(filtered.cols()).maxCoeff();
  }
  return result;
}

Eigen::VectorXd ThresholdRows::row(const StartBefore& start, Index at) const {
  Eigen::VectorXd result = Eigen::VectorXd::Constant(unknowns(), constant);
  const Index row = history + at;
  result.head(filtered.cols()) = filtered.row(row);
  if (start.ticks > 0) {
    result.head(filtered.cols()) -= start.kept * filtered.row(row - start.ticks);
  }
  return result;
}

Eigen::VectorXd tightest(const ThresholdParts& parts, const Eigen::VectorXd& lowest,
                         const Eigen::VectorXd& price,
                         const std::optional<Eigen::VectorXd>& highest) {
  const Eigen::VectorXd cost = mean_row(parts);
  Eigen::VectorXd size = Eigen::VectorXd::Ones(cost.size());
  for (Index k = 0; k < cost.size(); ++k) {
    if (cost[k] > 0) size[k] = 1 / cost[k];
  }
  // In units in which every number adds the same to the mean threshold.
  const Eigen::VectorXd scaled_cost = (cost.array() * size.array()).max(1e-3) * price.array();
  const Eigen::VectorXd most =
      highest.value_or(Eigen::VectorXd::Constant(cost.size(), kInfinity)).cwiseQuotient(size);
  Programme programme(scaled_cost, lowest.cwiseQuotient(size), most.cwiseMin(kInfinity));
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
