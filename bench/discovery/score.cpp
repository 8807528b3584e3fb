#include "score.hpp"

#include <algorithm>

namespace offnominal::bench {

using desk::EffectAt;
using desk::holds;
using desk::holds_in_any;

namespace {

// In one class with a true effect.
bool is_excused(const Effects& truth, const std::vector<Effects>& classes, const EffectAt& named) {
  return std::any_of(classes.begin(), classes.end(), [&](const Effects& same) {
    return holds(same, named) && std::any_of(same.begin(), same.end(), [&](const EffectAt& one) {
             return holds(truth, one);
           });
  });
}

}  // namespace

Score score_of(const Effects& truth, const Effects& named, const std::vector<Effects>& classes) {
  Score score;
  const auto every = [&](const auto& condition) {
    return !truth.empty() && std::all_of(truth.begin(), truth.end(), condition);
  };
  score.first = !named.empty() && holds(truth, named.front());
  score.sure = score.first && !holds_in_any(classes, named.front());
  score.all_named = every([&](const EffectAt& one) { return holds(named, one); });
  score.in_class =
      every([&](const EffectAt& one) { return holds(named, one) || holds_in_any(classes, one); });
  score.wrong = std::any_of(named.begin(), named.end(), [&](const EffectAt& one) {
    return !holds(truth, one) && !is_excused(truth, classes, one);
  });
  score.wrong |= std::any_of(classes.begin(), classes.end(), [&](const Effects& same) {
    return std::none_of(same.begin(), same.end(),
                        [&](const EffectAt& one) { return holds(truth, one); });
  });
  return score;
}

}  // namespace offnominal::bench
