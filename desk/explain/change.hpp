#pragma once

#include <array>
#include <optional>
#include <vector>

#include "explain/found_model.hpp"
#include "explain/search.hpp"
#include "identify/estimates.hpp"
#include "identify/regression.hpp"

namespace offnominal::desk {

// Something that a joint has, or has no longer, from a moment of a recording on, or in later ones.
struct FoundChange {
  Term term;  // its effect, in the part of the recording behind that moment, or in the later ones
  // Where the moment lies, 95 %, by the recording's time stamps; none: it was given.
  std::optional<std::array<double, 2>> at_s = {};
  // Where the moment lies at which it is gone again; none: it stays.
  std::optional<std::array<double, 2>> until_s = {};
  std::vector<Term> alike;  // what else describes the recordings as well, best first
  double p = 1;             // of the whole search for changes, wild block bootstrap
  std::vector<Estimate> numbers;
};

// What changes in the middle of one of the recordings, or is different in `given`, beside a model:
// a payload on the last link, and per joint viscous or Coulomb friction, a constant torque, the
// torque constant. `terms`: of the model; those that count time are left out of it, since they may
// be bent to a change. A change is told where it takes as much as an effect has to
// (find_model.hpp), beside that effect all the time, where no drift of the effect (a cubic in time,
// or one that fades) makes the recordings as likely, where free functions of position, velocity and
// load of the joints that it acts on do not take two thirds of it, or take less than it does
// (another motion behind that moment is no change), and where its size is told from nothing. What
// comes and goes again is one change. Where `given` says when, neither the moment nor its
// suddenness is asked of. In the order of how likely they make the recordings.
std::vector<FoundChange> changes_beside(const Regression& regression, std::vector<Term> terms,
                                        const SearchOptions& options,
                                        const std::optional<TimeSpan>& given = {});

// Whether they are of the same effects and joints, at the same moments to a fifth of a second.
bool are_same(const std::vector<FoundChange>& a, const std::vector<FoundChange>& b);

std::vector<Term> terms_of(const std::vector<FoundChange>& changes);

// Whether time that was not fitted is clearly more likely by the model beside `changes`, on the
// joints that they act on: what else was found beside them or without is of the others. `with` is
// of `regression`, `without` of `regression_without`.
bool predicts_better(const std::vector<FoundChange>& changes, const Regression& regression,
                     const FoundModel& with, const Regression& regression_without,
                     const FoundModel& without);

}  // namespace offnominal::desk
