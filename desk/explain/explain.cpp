#include "explain/explain.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "explain/explainer.hpp"
#include "explain/verdict.hpp"

namespace offnominal::desk {

Explanation explain(const RobotDescription& robot, std::vector<Log> logs, std::vector<Log> holdout,
                    const ExplainOptions& options, const OnProgress& on_progress) {
  if (on_progress) on_progress("examining the recordings");
  return explain(robot, treated(robot, std::move(logs), std::move(holdout), options.keep), options,
                 on_progress);
}

namespace {

void say_what_was_carried(const std::vector<Log>& logs, Explanation& result) {
  for (const Log& log : logs) {
    if (!log.payload) continue;
    result.advice.push_back(fmt::format("{}: with a payload of {}, part of the model there",
                                        log.file, words_of(*log.payload)));
  }
}

// Of what refuses nothing.
std::string words_of_hint(const DataFault& hint) {
  if (hint.overruled) return hint.words + ", which --keep overrules";
  if (hint.kind == DataFaultKind::kNothingLeft)
    return hint.words + ", so that nothing is said of it";
  const bool of_zero = hint.kind == DataFaultKind::kJointZero;
  const char* meanwhile = !hint.or_masses ? ", which changes nothing here; to mend: "
                          : of_zero       ? ": masses that are off are looked for; to mend a zero: "
                                          : ": what else it could be is looked for; to mend: ";
  return hint.words + meanwhile + hint.mend;
}

// Of a recording of which nothing is left, what the model leaves of it as it is is still shown.
Explanation explain_as_it_is(const RobotDescription& robot, Treated recordings,
                             const ExplainOptions& options, const OnProgress& on_progress) {
  for (std::vector<Log>* group : {&recordings.logs, &recordings.holdout}) {
    for (Log& log : *group) log.left_out.clear();
  }
  return Explainer(robot, recordings.logs, recordings.holdout, options, on_progress).run(false, {});
}

struct Explained {
  Explanation result;
  std::string left_out;  // what was not searched, in words; empty where all was
};

// The same with pushes left out of the recordings.
struct ExplainedWithout {
  Explained explained;
  RobotDescription with_all_found;
};

ExplainedWithout explain_without(const std::vector<Push>& pushes, const RobotDescription& robot,
                                 const Treated& recordings, const ExplainOptions& options,
                                 const OnProgress& on_progress) {
  Treated others{recordings.logs, recordings.holdout, {}};
  leave_out(pushes, others.logs);
  leave_out(pushes, others.holdout);
  Explainer explainer(robot, others.logs, others.holdout, options, on_progress);
  Explanation result = explainer.run(true, pushes);
  return {{std::move(result), explainer.left_out()}, explainer.with_all_found()};
}

// Those of the pushes that this robot does not explain.
std::vector<Push> unexplained_by(const RobotDescription& robot, const Treated& recordings,
                                 const ExplainOptions& options, const OnProgress& on_progress,
                                 std::vector<Push> pushes) {
  const std::vector<Push> left =
      Explainer(robot, recordings.logs, recordings.holdout, options, on_progress).pushes();
  std::erase_if(pushes, [&](const Push& one) { return !is_among(one, left); });
  return pushes;
}

// What pushes the arm for a moment is told by itself, and left out of everything else. What is
// missing may stand out for a moment too, where a joint is at its fastest: then it is no push.
Explained explain_beside_pushes(const RobotDescription& robot, const Treated& recordings,
                                const ExplainOptions& options, bool search,
                                const OnProgress& on_progress) {
  std::vector<Push> pushes;
  {
    Explainer explainer(robot, recordings.logs, recordings.holdout, options, on_progress);
    if (search) pushes = explainer.pushes();
    if (pushes.empty()) {
      Explanation result = explainer.run(search, {});
      return {std::move(result), explainer.left_out()};
    }
  }
  ExplainedWithout told = explain_without(pushes, robot, recordings, options, on_progress);
  if (told.explained.result.found.empty()) return std::move(told.explained);
  std::vector<Push> still =
      unexplained_by(told.with_all_found, recordings, options, on_progress, pushes);
  if (still.size() == pushes.size()) return std::move(told.explained);
  return explain_without(still, robot, recordings, options, on_progress).explained;
}

}  // namespace

Explanation explain(const RobotDescription& robot, const Treated& recordings,
                    const ExplainOptions& options, const OnProgress& on_progress) {
  std::vector<DataFault> faults;
  std::vector<DataFault> hints;
  std::vector<DataFault> left_out;
  bool nothing_left = false;
  for (const DataFault& fault : recordings.faults) {
    const bool nothing = fault.kind == DataFaultKind::kNothingLeft;
    nothing_left = nothing_left || (nothing && fault.certain);
    // Velocities come from the positions here: what was recorded of them spoils nothing.
    const bool hint = fault.kind == DataFaultKind::kVelocity || fault.overruled ||
                      fault.or_masses || (nothing && !fault.certain);
    auto& list = hint ? hints : !fault.left_out_of.empty() ? left_out : faults;
    list.push_back(fault);
  }
  Explained explained;
  Explanation& result = explained.result;
  if (nothing_left) {
    result = explain_as_it_is(robot, recordings, options, on_progress);
  } else {
    explained = explain_beside_pushes(robot, recordings, options, faults.empty(), on_progress);
  }
  if (!faults.empty()) {
    result.data_faults = std::move(faults);
    judge_whole(result);
  }
  for (const DataFault& hint : hints) {
    result.advice.push_back(words_of_hint(hint));
  }
  result.data_hints = std::move(hints);
  result.left_out = std::move(left_out);
  if (!explained.left_out.empty()) result.advice.push_back(std::move(explained.left_out));
  say_what_was_carried(recordings.logs, result);
  say_what_was_carried(recordings.holdout, result);
  return std::move(result);
}

}  // namespace offnominal::desk
