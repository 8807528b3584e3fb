#include "results.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "common/error.hpp"
#include "common/file.hpp"
#include "write_cases.hpp"

namespace offnominal::bench {

using desk::EffectAt;
using desk::benchmark::Asked;
using desk::benchmark::Case;

namespace {

using Classes = std::vector<std::vector<EffectAt>>;

bool has(const std::vector<EffectAt>& effects, const EffectAt& one) {
  return std::find(effects.begin(), effects.end(), one) != effects.end();
}

// "viscous_friction@1, coulomb_friction@2 or stribeck_friction@2".
std::string said_of(const std::vector<EffectAt>& named, const Classes& classes) {
  const auto is_sure = [&](const EffectAt& one) {
    return std::none_of(classes.begin(), classes.end(),
                        [&](const auto& same) { return has(same, one); });
  };
  std::vector<std::string> all;
  for (const EffectAt& one : named) {
    if (is_sure(one)) all.push_back(name_at(one));
  }
  for (const auto& same : classes) {
    std::vector<std::string> names;
    for (const EffectAt& one : same) names.push_back(name_at(one));
    all.push_back(fmt::format("{}", fmt::join(names, " or ")));
  }
  return all.empty() ? "nothing" : fmt::format("{}", fmt::join(all, ", "));
}

Asked asked_of(const EffectAt& what, int class_size, const std::string& instead) {
  Asked asked;
  asked.effect = std::string(what.name());
  asked.joint = static_cast<int>(what.joint) + 1;
  asked.class_size = class_size;
  asked.outcome = class_size == 0   ? desk::benchmark::Outcome::kMissed
                  : class_size == 1 ? desk::benchmark::Outcome::kNamed
                                    : desk::benchmark::Outcome::kInClass;
  if (class_size == 0) asked.instead = instead;
  return asked;
}

// 0: neither named nor in a class.
int class_size_of(const EffectAt& what, const Outcome& outcome) {
  for (const Effects& same : outcome.classes) {
    // What could be the file's own numbers as well stands in a class by itself.
    if (has(same, what)) return std::max<int>(2, static_cast<int>(same.size()));
  }
  return has(outcome.named, what) ? 1 : 0;
}

// Of what is outside of the list, and of a fault of the recording: whether the verdict says so.
Asked asked_of_verdict(const Outcome& outcome) {
  const auto at = outcome.hidden.find('@');
  Asked asked;
  asked.effect = outcome.hidden.substr(0, at);
  if (at != std::string::npos) asked.joint = std::stoi(outcome.hidden.substr(at + 1));
  asked.class_size = outcome.right_verdict ? 1 : 0;
  asked.outcome =
      outcome.right_verdict ? desk::benchmark::Outcome::kNamed : desk::benchmark::Outcome::kMissed;
  if (!outcome.right_verdict) asked.instead = outcome.verdict;
  return asked;
}

Case case_of(const CaseGroup& group, const Outcome& outcome) {
  Case one;
  one.group = group.name;
  one.seed = outcome.request.seed;
  one.hidden = outcome.hidden.empty() ? "nothing" : outcome.hidden;
  one.said = said_of(outcome.named, outcome.classes);
  one.verdict = outcome.verdict;
  one.failed = outcome.refused.empty() ? outcome.failed : outcome.refused;
  one.time_s = outcome.time_s;
  const std::string instead = outcome.named.empty() ? outcome.verdict : name_at(outcome.named[0]);
  for (const EffectAt& what : outcome.truth) {
    one.asked.push_back(asked_of(what, class_size_of(what, outcome), instead));
  }
  const bool by_verdict =
      group.kind == CaseGroup::Kind::kOutside || group.kind == CaseGroup::Kind::kDataFault;
  if (by_verdict && one.failed.empty()) one.asked.push_back(asked_of_verdict(outcome));
  if (!outcome.score.wrong) return one;
  for (const EffectAt& what : outcome.named) {
    if (!has(outcome.truth, what)) one.wrong.push_back(name_at(what));
  }
  if (one.wrong.empty()) one.wrong.push_back(outcome.verdict);
  return one;
}

Case case_of(const ArmGroup& group, const ArmOutcome& outcome) {
  Case one;
  one.group = group.name;
  one.seed = outcome.request.seed;
  one.hidden = text_of(outcome.truth);
  one.said = said_of(outcome.named, outcome.classes);
  one.verdict = outcome.verdict;
  one.failed = outcome.refused.empty() ? outcome.failed : outcome.refused;
  one.time_s = outcome.time_s;
  for (const ArmAsked& what : outcome.score.asked) {
    Asked asked = asked_of(what.what, what.named ? 1 : what.class_size, what.instead);
    asked.share = what.share;
    one.asked.push_back(std::move(asked));
  }
  for (const EffectAt& what : outcome.score.wrong) one.wrong.push_back(name_at(what));
  for (int i = 0; i < outcome.score.false_pushes; ++i) one.wrong.emplace_back("push");
  return one;
}

template <typename Group, typename OneOutcome, typename WriteCases>
void write_all(const ResultsRequest& request, const std::string& name,
               const std::vector<Group>& groups,
               const std::vector<std::vector<OneOutcome>>& outcomes, const WriteCases& write) {
  std::vector<std::filesystem::path> folders;
  if (!request.cases.empty()) folders = write(groups, request.cases);
  const std::filesystem::path beside =
      std::filesystem::absolute(request.file).lexically_normal().parent_path();
  desk::benchmark::Results results{name, request.command, request.seed, {}};
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const OneOutcome& outcome : outcomes[g]) {
      Case one = case_of(groups[g], outcome);
      one.number = static_cast<std::int64_t>(results.cases.size());
      if (!folders.empty()) {
        const auto& folder = folders[results.cases.size()];
        one.folder = std::filesystem::relative(std::filesystem::absolute(folder), beside).string();
      }
      results.cases.push_back(std::move(one));
    }
  }
  desk::benchmark::write_benchmark(request.file, results, desk::existing_if(request.force));
  fmt::print(stderr, "written: {}\n", request.file);
}

}  // namespace

void check_results(const ResultsRequest& request) {
  if (request.file.empty()) return;
  std::error_code ignored;
  if (!request.force && std::filesystem::exists(request.file, ignored)) {
    throw desk::InputError(
        {request.file, "", "a file that is there", "a new one", "say --force, or name another"});
  }
  desk::check_can_be_written(request.file);
  const bool has_cases = !request.cases.empty() &&
                         std::filesystem::exists(request.cases, ignored) &&
                         !std::filesystem::is_empty(request.cases, ignored);
  if (!has_cases) return;
  throw desk::InputError({request.cases, "", "a folder with something in it", "a new folder",
                          "name another one with --write"});
}

void write_results(const ResultsRequest& request, const std::vector<CaseGroup>& groups,
                   const std::vector<std::vector<Outcome>>& outcomes) {
  write_all(request, "discovery", groups, outcomes, write_cases);
}

void write_results(const ResultsRequest& request, const std::vector<ArmGroup>& groups,
                   const std::vector<std::vector<ArmOutcome>>& outcomes) {
  write_all(request, "discovery, arms", groups, outcomes, write_arm_cases);
}

}  // namespace offnominal::bench
