#include "arm_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "table_text.hpp"

namespace offnominal::bench {

namespace {

template <typename Value>
Value median_of(std::vector<Value> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

bool names_what_is_not_there(const ArmScore& score) {
  return !score.wrong.empty() || score.false_pushes > 0;
}

void count_outcome(const ArmOutcome& one, ArmSummary& line) {
  ++line.cases;
  if (!one.refused.empty()) {
    ++line.refused;
    return;
  }
  if (!one.failed.empty()) ++line.failed;
  for (const ArmJointScore& joint : one.score.joints) {
    if (joint.is_asked) line.answered.count(joint.is_answered);
    line.wrong.count(joint.is_wrong);
  }
  line.wrong_cases.count(names_what_is_not_there(one.score));
  if (one.score.payload) line.payload.count(*one.score.payload);
  if (one.score.moment) line.moment.count(*one.score.moment);
  for (const ArmAsked& asked : one.score.asked) {
    if (asked.class_size > 0) line.class_sizes.push_back(asked.class_size);
  }
  ++line.verdicts[one.verdict];
  line.times_s.push_back(one.time_s);
}

std::string line_of(const ArmSummary& line) {
  std::string verdicts = histogram(line.verdicts);
  if (line.refused > 0) verdicts += fmt::format("; refused by the simulator {}", line.refused);
  const double worst =
      line.times_s.empty() ? 0 : *std::max_element(line.times_s.begin(), line.times_s.end());
  return fmt::format("| {} | {} | {} ({}) | {} | {} | {} | {} | {} | {:.1f} / {:.1f} | {} |\n",
                     line.words, line.cases, percent(line.answered), line.answered.of,
                     line.class_sizes.empty() ? "-" : std::to_string(median_of(line.class_sizes)),
                     percent(line.wrong), percent(line.wrong_cases), percent(line.payload),
                     percent(line.moment), median_of(line.times_s), worst, verdicts);
}

bool is_right(const ArmOutcome& one) {
  return one.failed.empty() && !names_what_is_not_there(one.score) &&
         one.score.payload.value_or(true) && one.score.moment.value_or(true) &&
         std::all_of(one.score.joints.begin(), one.score.joints.end(),
                     [](const ArmJointScore& joint) { return joint.is_answered; });
}

std::string names_of(const std::vector<desk::EffectAt>& effects) {
  std::string text;
  for (const auto& one : effects) {
    text += (text.empty() ? "" : ", ") + name_at(one);
  }
  return text.empty() ? "nothing" : text;
}

}  // namespace

std::vector<ArmSummary> summarise_arms(const std::vector<ArmGroup>& groups,
                                       const std::vector<std::vector<ArmOutcome>>& outcomes) {
  std::vector<ArmSummary> lines;
  ArmSummary all;
  all.group = "all";
  all.words = "all that hide something";
  int hiding = 0;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    ArmSummary line;
    line.group = groups[g].name;
    line.words = groups[g].words;
    const bool hides = groups[g].hides != ArmHides::kNothing;
    if (hides) ++hiding;
    for (const ArmOutcome& one : outcomes[g]) {
      count_outcome(one, line);
      if (hides) count_outcome(one, all);
    }
    lines.push_back(std::move(line));
  }
  if (hiding > 1) lines.push_back(std::move(all));
  return lines;
}

std::vector<ArmEffectSummary> summarise_arm_effects(
    const std::vector<std::vector<ArmOutcome>>& outcomes) {
  std::map<std::string, ArmEffectSummary> effects;
  for (const auto& group : outcomes) {
    for (const ArmOutcome& one : group) {
      for (const ArmAsked& asked : one.score.asked) {
        const std::string name(asked.what.name());
        ArmEffectSummary& line = effects[name];
        line.effect = name;
        line.named.count(asked.named);
        line.in_class.count(asked.class_size > 0 && asked.class_size <= 3);
        if (asked.class_size > 3) ++line.instead["in a larger class"];
        if (asked.class_size == 0) ++line.instead[asked.instead];
      }
    }
  }
  std::vector<ArmEffectSummary> lines;
  for (const auto& [name, line] : effects) lines.push_back(line);
  return lines;
}

std::vector<Goal> arm_goals_of(const std::vector<ArmSummary>& lines) {
  std::vector<Goal> goals;
  const auto add = [&](const std::string& what, const Rate& rate, const std::string& wanted,
                       double low, double high) {
    if (rate.of == 0) return;
    goals.push_back({what, wanted,
                     fmt::format("{:.1f} % ({} of {})", rate.percent(), rate.hits, rate.of),
                     rate.percent() >= low && rate.percent() <= high});
  };
  Rate answered, wrong, payload, moment, empty;
  std::vector<int> sizes;
  double worst_s = 0;
  for (const ArmSummary& line : lines) {
    if (line.group == "all") continue;
    for (const double time_s : line.times_s) worst_s = std::max(worst_s, time_s);
    if (line.group == "nothing") {
      empty = line.wrong_cases;
      continue;
    }
    answered.add(line.answered);
    wrong.add(line.wrong);
    payload.add(line.payload);
    moment.add(line.moment);
    sizes.insert(sizes.end(), line.class_sizes.begin(), line.class_sizes.end());
  }
  add("joints whose missing effects are all named or in a class of at most three", answered,
      ">= 95 %", 95, 100);
  if (!sizes.empty()) {
    goals.push_back({"... size of the class, median", "1", std::to_string(median_of(sizes)),
                     median_of(sizes) == 1});
  }
  add("something named that is not there, of the joints", wrong, "<= 1 %", 0, 1);
  add("... of the recordings with nothing hidden", empty, "0", 0, 0);
  add("payload of the last link within 10 % of its mass", payload, ">= 90 %", 90, 100);
  add("change or push within 0.1 s", moment, ">= 90 %", 90, 100);
  goals.push_back({"time of a case, one thread, worst", "<= 30 s", fmt::format("{:.1f} s", worst_s),
                   worst_s <= 30});
  return goals;
}

std::string table_of(const std::vector<ArmSummary>& lines) {
  std::string text =
      "| cases | n | joints answered % (of) | class, median | joints with a wrong name % | "
      "recordings with one % | payload 10 % | moment 0.1 s % | median / worst s | verdicts |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n";
  for (const ArmSummary& line : lines) text += line_of(line);
  return text;
}

std::string table_of(const std::vector<ArmEffectSummary>& effects) {
  std::string text =
      "| effect | asked for | named alone % | or in a class of three % | instead |\n"
      "|---|---|---|---|---|\n";
  for (const ArmEffectSummary& one : effects) {
    text += fmt::format("| {} | {} | {} | {} | {} |\n", one.effect, one.named.of,
                        percent(one.named), percent(one.in_class), histogram(one.instead));
  }
  return text;
}

std::string failures_of(const ArmGroup& group, const std::vector<ArmOutcome>& outcomes) {
  std::string text;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const ArmOutcome& one = outcomes[i];
    if (!one.refused.empty() || is_right(one)) continue;
    text += fmt::format("{} {} seed {}: hidden {} -> {}; named {}", group.name, i, one.request.seed,
                        text_of(one.truth), one.verdict, names_of(one.named));
    for (const auto& same : one.classes) text += "; class {" + names_of(same) + "}";
    if (!one.score.wrong.empty()) text += "; wrong " + names_of(one.score.wrong);
    if (one.score.false_pushes > 0) text += "; told of a push that is none";
    if (!one.failed.empty()) text += "; " + one.failed;
    text += "\n";
  }
  return text;
}

nlohmann::ordered_json json_of(const ArmSummary& line) {
  const auto rate = [](const Rate& one) {
    return nlohmann::ordered_json{{"hits", one.hits}, {"of", one.of}};
  };
  return {{"group", line.group},
          {"cases", line.cases},
          {"refused", line.refused},
          {"failed", line.failed},
          {"joints_answered", rate(line.answered)},
          {"class_median", median_of(line.class_sizes)},
          {"joints_wrong", rate(line.wrong)},
          {"recordings_wrong", rate(line.wrong_cases)},
          {"payload_within_tenth", rate(line.payload)},
          {"moment_within_tenth_s", rate(line.moment)},
          {"median_s", median_of(line.times_s)},
          {"verdicts", line.verdicts}};
}

}  // namespace offnominal::bench
