#include "look/nameless.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/nearest.hpp"
#include "look/relation.hpp"
#include "look/unit_ratios.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Values = std::map<std::string, VectorXd>;

VectorXd steps_of(const VectorXd& x) { return x.tail(x.size() - 1) - x.head(x.size() - 1); }

bool is_row_count(const VectorXd& x) { return x.size() > 1 && (steps_of(x).array() == 1).all(); }

class Guesser {
 public:
  Guesser(const std::vector<std::string>& names, const Values& values)
      : names_(names), values_(values) {}

  NamelessGuess guess(int joints, double period_s, const VectorXd& t_s) {
    t_s_ = t_s;
    if (t_s_.size() == 0) take_time(period_s);
    if (t_s_.size() > 0) take_pairs();
    const auto wanted = joints > 0 ? static_cast<std::size_t>(joints) : pairs_.size();
    if (pairs_.size() == wanted && wanted > 0) {
      for (const Pair& pair : pairs_) guess_.roles.position.push_back(name_of(pair.position));
      // Of all joints or of none.
      if (std::all_of(pairs_.begin(), pairs_.end(),
                      [](const Pair& pair) { return pair.is_told(); })) {
        for (const Pair& pair : pairs_)
          guess_.roles.velocity.push_back(name_of(pair.velocities[0]));
      }
    }
    say_pairs(joints);
    for (const std::string& name : names_) {
      if (!is_taken(name)) guess_.left.push_back(name);
    }
    if (guess_.left.size() == wanted && !guess_.roles.velocity.empty() && none_is_known_already()) {
      guess_.roles.torque = guess_.left;
      guess_.left.clear();
    }
    return std::move(guess_);
  }

 private:
  // By their places among the columns that move.
  struct Pair {
    Index position = 0;
    std::vector<Index> velocities;  // the best first, and all that are hardly worse
    [[nodiscard]] bool is_told() const { return velocities.size() == 1; }
  };

  const std::string& name_of(Index moving) const {
    return moving_[static_cast<std::size_t>(moving)];
  }

  void take_time(double period_s) {
    if (names_.empty()) return;
    std::size_t at = 0;
    if (is_row_count(values_.at(names_[0])) && names_.size() > 1) {
      counter_ = names_[0];
      guess_.notes.push_back("column 1 counts the rows");
      at = 1;
    }
    const VectorXd& first = values_.at(names_[at]);
    if (period_s > 0) {
      t_s_ = VectorXd::LinSpaced(first.size(), 0, period_s * static_cast<double>(first.size() - 1));
    } else if (is_clock(first)) {
      guess_.roles.time = names_[at];
      guess_.notes.push_back(fmt::format("column {} ascends evenly, as a clock does", names_[at]));
      t_s_ = first;
    }
  }

  bool is_taken(const std::string& name) const {
    const auto has = [&](const std::vector<std::string>& taken) {
      return std::find(taken.begin(), taken.end(), name) != taken.end();
    };
    return name == guess_.roles.time.value_or("") || name == counter_ ||
           has(guess_.roles.position) || has(guess_.roles.velocity);
  }

  // A position and what fits best as its velocity; the derivative of a velocity is left.
  void take_pairs() {
    moving_ = moving_columns();
    const auto n = static_cast<Index>(moving_.size());
    fit_ = Eigen::MatrixXd::Zero(n, n);  // row: position, column: velocity
    for (Index i = 0; i < n; ++i) {
      for (Index k = 0; k < n; ++k) {
        if (i != k) fit_(i, k) = fit_of(i, k);
      }
    }
    std::vector<Pair> pairs;
    for (Index i = 0; i < n; ++i) {
      Pair pair{i, velocities_of(i)};
      if (!pair.velocities.empty() && is_position_of(i, pair.velocities[0])) {
        pairs.push_back(std::move(pair));
      }
    }
    for (const Pair& pair : pairs) {
      const bool is_velocity = std::any_of(pairs.begin(), pairs.end(), [&](const Pair& other) {
        return std::find(other.velocities.begin(), other.velocities.end(), pair.position) !=
               other.velocities.end();
      });
      if (!is_velocity) pairs_.push_back(pair);
    }
  }

  // The best, and those that are hardly worse.
  std::vector<Index> velocities_of(Index i) const {
    std::vector<Index> velocities;
    Index best = 0;
    if (fit_.cols() == 0 || fit_.row(i).maxCoeff(&best) <= 0) return velocities;
    velocities.push_back(best);
    for (Index k = 0; k < fit_.cols(); ++k) {
      if (k != best && is_hardly_worse(fit_(i, k), fit_(i, best))) velocities.push_back(k);
    }
    return velocities;
  }

  // Whether no other goes with it clearly better, and none that stands before it as well.
  bool is_position_of(Index i, Index velocity) const {
    const double best = fit_.col(velocity).maxCoeff();
    for (Index k = 0; k < i; ++k) {
      if (is_hardly_worse(fit_(k, velocity), best)) return false;
    }
    return is_hardly_worse(fit_(i, velocity), best);
  }

  // What is left for torques must not be a position, a velocity or a clock a second time, nor
  // nothing at all. Says why not.
  bool none_is_known_already() {
    const std::size_t before = guess_.notes.size();
    for (const std::string& name : guess_.left) {
      if (const std::string known = known_already(name); !known.empty()) {
        guess_.notes.push_back(fmt::format("column {} {}: it is taken for no torque", name, known));
      }
    }
    return guess_.notes.size() == before;
  }

  std::string known_already(const std::string& name) const {
    const VectorXd& x = values_.at(name);
    if (x.size() > 1 && steps_of(x).minCoeff() > 0) return "ascends all the time";
    const auto at = std::find(moving_.begin(), moving_.end(), name);
    if (at == moving_.end()) return "never changes where it was looked at";
    const auto left = static_cast<Index>(at - moving_.begin());
    for (const Pair& pair : pairs_) {
      const Index velocity = pair.velocities[0];
      if (fit_(left, velocity) > 0) {
        return fmt::format("has {} as its derivative, as {} does", name_of(velocity),
                           name_of(pair.position));
      }
      if (fit_(velocity, left) > 0) {
        return fmt::format("is the derivative of {}, an acceleration", name_of(velocity));
      }
      for (const Index taken : {pair.position, velocity}) {
        if (are_alike(left, taken)) return fmt::format("is {} times a factor", name_of(taken));
      }
    }
    return {};
  }

  // But for a factor and an offset.
  bool are_alike(Index a, Index b) const {
    constexpr double kSame = 1 - 1e-6;
    const VectorXd x = smoothed_[static_cast<std::size_t>(a)].value;
    const VectorXd y = smoothed_[static_cast<std::size_t>(b)].value;
    const VectorXd of_x = x.array() - x.mean();
    const VectorXd of_y = y.array() - y.mean();
    return std::abs(of_x.dot(of_y)) >= kSame * of_x.norm() * of_y.norm();
  }

  // Above 0 where k is the derivative of i, by a factor that units have.
  double fit_of(Index i, Index k) const {
    const Relation relation =
        relation_of(smoothed_[static_cast<std::size_t>(i)], smoothed_[static_cast<std::size_t>(k)]);
    if (!relation.ratio || relation.correlation < kDerivativeCorrelation) return 0;
    return is_near(*relation.ratio, 1) || unit_ratio_of(*relation.ratio) != nullptr
               ? relation.correlation
               : 0;
  }

  std::vector<std::string> moving_columns() {
    std::vector<std::string> moving;
    const auto [first, count] = judged_rows(t_s_.size());
    const VectorXd t_s = t_s_.segment(first, count);
    Eigen::MatrixXd all(count, 0);
    for (const std::string& name : names_) {
      const VectorXd& x = values_.at(name);
      if (is_taken(name) || x.size() != t_s_.size()) continue;
      const VectorXd part = x.segment(first, count);
      if (part.maxCoeff() == part.minCoeff()) continue;
      all.conservativeResize(Eigen::NoChange, all.cols() + 1);
      all.col(all.cols() - 1) = part;
      moving.push_back(name);
    }
    if (moving.empty()) return moving;
    const UnbrokenRows stretch = longest_stretch(t_s, all);
    if (stretch.count < kFewestJudged) return {};
    for (Index i = 0; i < all.cols(); ++i) {
      smoothed_.push_back(smoothed(all.col(i).segment(stretch.first, stretch.count),
                                   t_s.segment(stretch.first, stretch.count)));
    }
    return moving;
  }

  void say_pairs(int joints) {
    std::vector<std::string> words;
    for (const Pair& pair : pairs_) {
      if (pair.is_told()) {
        words.push_back(
            fmt::format("{} of {}", name_of(pair.velocities[0]), name_of(pair.position)));
        continue;
      }
      std::vector<std::string> alike;
      for (const Index velocity : pair.velocities) alike.push_back(name_of(velocity));
      guess_.notes.push_back(fmt::format(
          "columns {} go as the derivative of {}, one hardly better than the other: which is the "
          "velocity and which a torque or of another joint is not told by the numbers; say "
          "velocity = [...] and torque = [...]",
          list_of(alike), name_of(pair.position)));
    }
    if (!words.empty()) {
      guess_.notes.push_back("columns that are the derivative of others: " + list_of(words));
    }
    if (!pairs_.empty() && guess_.roles.position.empty()) {
      guess_.notes.push_back(
          fmt::format("the robot has {} joints: positions and velocities are not guessed", joints));
    }
  }

  const std::vector<std::string>& names_;
  const Values& values_;
  NamelessGuess guess_;
  std::string counter_;
  VectorXd t_s_;
  std::vector<std::string> moving_;  // columns that may be positions or velocities
  std::vector<Smoothed> smoothed_;   // of each
  Eigen::MatrixXd fit_;              // of each as a velocity (column) to each as a position (row)
  std::vector<Pair> pairs_;
};

}  // namespace

bool is_clock(const VectorXd& x) {
  constexpr double kNearlyAll = 0.9;
  if (x.size() < 3 || !x.allFinite() || is_row_count(x)) return false;
  VectorXd steps = steps_of(x);
  if (!(steps.minCoeff() > 0)) return false;
  double* const middle = steps.data() + steps.size() / 2;
  std::nth_element(steps.data(), middle, steps.data() + steps.size());
  const double median = *middle;
  const auto even = ((steps.array() > median / 2) && (steps.array() < 2 * median)).count();
  return static_cast<double>(even) >= kNearlyAll * static_cast<double>(steps.size());
}

NamelessGuess roles_of_nameless(const std::vector<std::string>& names, const Values& values,
                                int joints, double period_s, const VectorXd& t_s) {
  return Guesser(names, values).guess(joints, period_s, t_s);
}

}  // namespace offnominal::desk
