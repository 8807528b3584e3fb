#include "look/by_derivative.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>

#include "common/nearest.hpp"
#include "look/relation.hpp"

namespace offnominal::desk {
namespace {

using Eigen::VectorXd;
using Values = std::map<std::string, VectorXd>;
using Columns = std::vector<std::string>;

class DerivativeJudge {
 public:
  DerivativeJudge(const Values& values, const VectorXd& t_s)
      : values_(values), t_s_(t_s), rows_(judged_rows(t_s.size())) {}

  // Of every joint whose two columns move, and of one at least.
  bool is_derivative(const Columns& velocity, const Columns& position) const {
    if (velocity.size() != position.size()) return false;
    int told = 0;
    for (std::size_t i = 0; i < position.size(); ++i) {
      const auto correlation = correlation_of(position[i], velocity[i]);
      if (!correlation) continue;
      if (!is_clear(*correlation, correlation_of(velocity[i], position[i]).value_or(0))) {
        return false;
      }
      ++told;
    }
    return told > 0;
  }

 private:
  // Of what has a narrow band each goes with the derivative of the other, with a sign.
  static bool is_clear(double correlation, double other_way) {
    return correlation >= kDerivativeCorrelation &&
           !is_hardly_worse(std::abs(other_way), correlation);
  }

  std::optional<double> correlation_of(const std::string& position,
                                       const std::string& velocity) const {
    const auto q = values_.find(position);
    const auto dq = values_.find(velocity);
    if (q == values_.end() || dq == values_.end() || q->second.size() != t_s_.size() ||
        dq->second.size() != t_s_.size()) {
      return std::nullopt;
    }
    const auto judged = [this](const VectorXd& x) { return x.segment(rows_.first, rows_.count); };
    const Relation relation = relation_of(judged(q->second), judged(dq->second), judged(t_s_));
    return relation.not_judged.empty() ? std::optional(relation.correlation) : std::nullopt;
  }

  const Values& values_;
  const VectorXd& t_s_;
  JudgedRows rows_;
};

void swap_positions_and_velocities(Roles& roles) {
  std::swap(roles.position, roles.velocity);
  std::swap(roles.position_of_motor, roles.velocity_of_motor);
}

}  // namespace

std::vector<std::string> set_right_by_derivative(Roles& roles, const Values& values,
                                                 const VectorXd& t_s) {
  std::vector<std::string> notes;
  if (roles.position.empty()) return notes;
  const DerivativeJudge judge(values, t_s);
  if (judge.is_derivative(roles.position, roles.velocity)) {
    notes.push_back(fmt::format(
        "the data show {} as the derivative of {}, whatever their names say: taken for velocities "
        "and positions",
        list_of(roles.position), list_of(roles.velocity)));
    swap_positions_and_velocities(roles);
    return notes;
  }
  if (judge.is_derivative(roles.velocity, roles.position)) return notes;
  const auto take = [&](const FamilyOfJoints& other) {
    roles.velocity = other.columns;
    roles.velocity_of_motor = other.of_motor;
    std::erase(roles.other_families, other.name);
  };
  const auto say = [&] {
    notes.push_back(fmt::format("{}: velocities, since the data show them as the derivative of {}",
                                list_of(roles.velocity), list_of(roles.position)));
  };
  for (const FamilyOfJoints& other : roles.other_velocities) {
    if (!judge.is_derivative(other.columns, roles.position)) continue;
    take(other);
    say();
    return notes;
  }
  for (const FamilyOfJoints& other : roles.other_positions) {
    const bool is_velocity = judge.is_derivative(other.columns, roles.position);
    if (!is_velocity && !judge.is_derivative(roles.position, other.columns)) continue;
    take(other);
    if (!is_velocity) swap_positions_and_velocities(roles);
    say();
    return notes;
  }
  return notes;
}

}  // namespace offnominal::desk
