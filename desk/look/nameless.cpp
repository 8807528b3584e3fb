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

constexpr Index kMostJudged = 20'000;  // rows, in the middle of the recording

VectorXd steps_of(const VectorXd& x) { return x.tail(x.size() - 1) - x.head(x.size() - 1); }

bool is_row_count(const VectorXd& x) { return x.size() > 1 && (steps_of(x).array() == 1).all(); }

class Guesser {
 public:
  Guesser(const std::vector<std::string>& names, const Values& values)
      : names_(names), values_(values) {}

  NamelessGuess guess(int joints, double period_s) {
    take_time(period_s);
    if (t_s_.size() > 0) take_pairs();
    const auto wanted = joints > 0 ? static_cast<std::size_t>(joints) : pairs_.size();
    if (pairs_.size() == wanted && wanted > 0) {
      for (const auto& [q, dq] : pairs_) {
        guess_.roles.position.push_back(q);
        guess_.roles.velocity.push_back(dq);
      }
    }
    say_pairs(joints);
    for (const std::string& name : names_) {
      if (!is_taken(name)) guess_.left.push_back(name);
    }
    if (guess_.left.size() == wanted && !guess_.roles.position.empty()) {
      guess_.roles.torque = guess_.left;
      guess_.left.clear();
    }
    return std::move(guess_);
  }

 private:
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

  // A pair that fits best on both sides; the derivative of a velocity is left.
  void take_pairs() {
    const std::vector<std::string> moving = moving_columns();
    if (moving.size() < 2) return;
    const auto n = static_cast<Index>(moving.size());
    Eigen::MatrixXd fit = Eigen::MatrixXd::Zero(n, n);  // row: position, column: velocity
    for (Index i = 0; i < n; ++i) {
      for (Index k = 0; k < n; ++k) {
        if (i != k) fit(i, k) = fit_of(i, k);
      }
    }
    std::map<std::string, std::string> velocity_of;
    for (Index i = 0; i < n; ++i) {
      Index best = 0;
      Index back = 0;
      if (fit.row(i).maxCoeff(&best) <= 0) continue;
      static_cast<void>(fit.col(best).maxCoeff(&back));
      if (back == i)
        velocity_of[moving[static_cast<std::size_t>(i)]] = moving[static_cast<std::size_t>(best)];
    }
    for (const std::string& name : moving) {
      const auto found = velocity_of.find(name);
      const bool is_velocity = std::any_of(velocity_of.begin(), velocity_of.end(),
                                           [&](const auto& pair) { return pair.second == name; });
      if (found != velocity_of.end() && !is_velocity) pairs_.emplace_back(name, found->second);
    }
  }

  // Above 0 where k is the derivative of i, by a factor that units have.
  double fit_of(Index i, Index k) const {
    constexpr double kAlike = 0.95;
    const Relation relation =
        relation_of(smoothed_[static_cast<std::size_t>(i)], smoothed_[static_cast<std::size_t>(k)]);
    if (!relation.ratio || relation.correlation < kAlike) return 0;
    return is_near(*relation.ratio, 1) || unit_ratio_of(*relation.ratio) != nullptr
               ? relation.correlation
               : 0;
  }

  std::vector<std::string> moving_columns() {
    std::vector<std::string> moving;
    const Index count = std::min(kMostJudged, t_s_.size());
    const Index first = (t_s_.size() - count) / 2;
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
    constexpr Index kFewest = 200;
    const UnbrokenRows stretch = longest_stretch(t_s, all);
    if (stretch.count < kFewest) return {};
    for (Index i = 0; i < all.cols(); ++i) {
      smoothed_.push_back(smoothed(all.col(i).segment(stretch.first, stretch.count),
                                   t_s.segment(stretch.first, stretch.count)));
    }
    return moving;
  }

  void say_pairs(int joints) {
    std::vector<std::string> words;
    for (const auto& [q, dq] : pairs_) words.push_back(fmt::format("{} of {}", dq, q));
    if (!words.empty()) {
      guess_.notes.push_back("columns that are the derivative of others: " + list_of(words));
    }
    if (!words.empty() && guess_.roles.position.empty()) {
      guess_.notes.push_back(
          fmt::format("the robot has {} joints: positions and velocities are not guessed", joints));
    }
  }

  const std::vector<std::string>& names_;
  const Values& values_;
  NamelessGuess guess_;
  std::string counter_;
  VectorXd t_s_;
  std::vector<Smoothed> smoothed_;
  std::vector<std::pair<std::string, std::string>> pairs_;
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
                                int joints, double period_s) {
  return Guesser(names, values).guess(joints, period_s);
}

}  // namespace offnominal::desk
