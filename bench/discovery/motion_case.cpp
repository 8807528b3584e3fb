#include "motion_case.hpp"

#include <chrono>
#include <exception>
#include <optional>
#include <utility>

#include "first_motion.hpp"
#include "motion/design.hpp"
#include "offnominal/sim/hidden/draw_robot.hpp"
#include "recorded_case.hpp"
#include "wall_clock.hpp"

namespace offnominal::bench {

namespace hidden = sim::hidden;
using desk::Explanation;
using desk::Verdict;

namespace {

constexpr int kAttempts = 8;

struct FirstRecording {
  desk::Log log;
  Explanation explanation;
};

Score score_against(const Effects& truth, const Explanation& e) {
  Effects named;
  for (const auto& finding : e.found) named.push_back(finding.what);
  return score_of(truth, named, e.ambiguous);
}

using FirstMotion = DesiredPositions (*)(const hidden::Nominal&, std::uint64_t, int);

// Of several draws of a first motion: the first on which `explain` is `ambiguous` with the hidden
// effect in a class, or else the first that does not excite enough.
std::optional<FirstRecording> undecided(const hidden::Request& request,
                                        const hidden::Nominal& nominal, const Effects& truth,
                                        FirstMotion draw) {
  const desk::RobotDescription robot = robot_of(nominal);
  std::optional<FirstRecording> not_excited;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const DesiredPositions motion = draw(nominal, request.seed, attempt);
    FirstRecording first;
    first.log = log_of(hidden::record_motion(request, motion.t_s, motion.q));
    first.explanation = desk::explain(robot, {first.log}, {}, {});
    const Verdict verdict = first.explanation.verdict;
    if (verdict == Verdict::kAmbiguous && score_against(truth, first.explanation).in_class) {
      return first;
    }
    if (verdict == Verdict::kNotExcited && !not_excited) not_excited = std::move(first);
  }
  return not_excited;
}

// What explain's advice says to run, as the command would.
desk::motion::DesignRequest request_for(const Explanation& e, const desk::RobotDescription& robot,
                                        std::uint64_t seed) {
  desk::motion::DesignRequest request;
  request.seed = seed;
  if (e.verdict != Verdict::kAmbiguous) return request;
  for (const auto& effect : e.ambiguous[0]) {
    request.effects.push_back(desk::motion::contender_of(text_of(effect), robot, "--separate"));
  }
  return request;
}

void play_and_judge(const hidden::Request& request, const hidden::Nominal& nominal,
                    const FirstRecording& first, Outcome& outcome) {
  const desk::RobotDescription robot = robot_of(nominal);
  outcome.before = desk::name_of(first.explanation.verdict);
  if (!first.explanation.ambiguous.empty()) {
    outcome.before += " " + text_of(first.explanation.ambiguous[0]);
  }
  const auto design =
      desk::motion::design_motion(robot, request_for(first.explanation, robot, request.seed));
  const auto& motion = design.fitted.motion;
  const desk::Log log = log_of(hidden::record_motion(request, motion.t_s, motion.q, 1));
  const double start_s = now_s();
  const Explanation e = desk::explain(robot, {log}, {}, {});
  outcome.time_s = now_s() - start_s;
  take_verdict(e, outcome);
}

}  // namespace

Outcome run_motion_case(const hidden::Request& request) {
  Outcome outcome;
  outcome.request = request;
  try {
    const hidden::DrawnRobot drawn = hidden::draw_robot(request);
    for (const auto& effect : drawn.truth.effects) {
      outcome.truth.push_back({info_named(hidden::name(effect.effect))->kind, effect.joint});
    }
    outcome.hidden = text_of(outcome.truth);
    std::optional<FirstRecording> first;
    if (request.excitation == hidden::Excitation::kRich) {
      first = undecided(request, drawn.nominal, outcome.truth, short_positions);
    }
    if (!first) first = undecided(request, drawn.nominal, outcome.truth, poor_positions);
    if (!first) {
      outcome.refused = "no first motion left it undecided";
      return outcome;
    }
    play_and_judge(request, drawn.nominal, *first, outcome);
  } catch (const std::exception& error) {
    outcome.failed = error.what();
    outcome.verdict = "error";
  }
  return outcome;
}

}  // namespace offnominal::bench
