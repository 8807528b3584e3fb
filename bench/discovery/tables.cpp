#include "tables.hpp"

#include <fmt/format.h>

#include "table_text.hpp"

namespace offnominal::bench {

namespace {

std::string line_of(const Summary& line) {
  const bool effects =
      line.kind == CaseGroup::Kind::kEffects || line.kind == CaseGroup::Kind::kMotion;
  const bool explains = line.method == "explain";
  const auto of_effects = [&](const Rate& rate) { return effects ? percent(rate) : "-"; };
  std::string verdicts = histogram(line.verdicts);
  if (line.refused > 0) verdicts += fmt::format("; refused by the simulator {}", line.refused);
  return fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
                     line.words, line.method, line.cases, of_effects(line.first),
                     explains ? of_effects(line.sure) : "-", of_effects(line.in_class),
                     of_effects(line.all_named), percent(line.wrong), percent(line.parameters),
                     percent(line.all_parameters), percent(line.covered), percent(line.holdout),
                     explains ? fmt::format("{:.1f} / {:.1f}", line.median_s, line.worst_s) : "-",
                     verdicts);
}

bool is_right(const CaseGroup& group, const Outcome& one) {
  if (!one.failed.empty()) return false;
  switch (group.kind) {
    case CaseGroup::Kind::kEffects:
      return one.score.in_class && !one.score.wrong;
    case CaseGroup::Kind::kMotion:
      return one.score.sure;
    case CaseGroup::Kind::kNone:
      return !one.score.wrong;
    case CaseGroup::Kind::kOutside:
    case CaseGroup::Kind::kDataFault:
      return one.right_detail;
  }
  return false;
}

}  // namespace

std::string table_of(const std::vector<Summary>& lines) {
  std::string text =
      "| cases | method | n | first % | and alone % | in class % | all named % | wrong % | "
      "parameters 10 % | all of a case | intervals cover % | hold-out <= 1.2 floor % | "
      "median / worst s | verdicts |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Summary& line : lines) text += line_of(line);
  return text;
}

std::string table_of(const std::vector<EffectSummary>& effects) {
  std::string text =
      "| effect | n | first % | and alone % | in class % | parameters 10 % | intervals cover % | "
      "stepwise first % | STLSQ first % | instead |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n";
  for (const EffectSummary& one : effects) {
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", one.effect,
                        one.first.of, percent(one.first), percent(one.sure), percent(one.in_class),
                        percent(one.parameters), percent(one.covered), percent(one.stepwise),
                        percent(one.thresholded), histogram(one.instead));
  }
  return text;
}

std::string table_of(const std::vector<Goal>& goals) {
  std::string text = "| number | wanted | measured | reached |\n|---|---|---|---|\n";
  for (const Goal& goal : goals) {
    text += fmt::format("| {} | {} | {} | {} |\n", goal.what, goal.wanted, goal.measured,
                        goal.reached ? "yes" : "no");
  }
  return text;
}

std::string failures_of(const CaseGroup& group, const std::vector<Outcome>& outcomes) {
  std::string text;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Outcome& one = outcomes[i];
    if (!one.refused.empty() || is_right(group, one)) continue;
    text += fmt::format("{} {} seed {}: hidden {} -> {}; named {}", group.name, i, one.request.seed,
                        one.hidden, one.verdict, text_of(one.named));
    for (const Effects& same : one.classes) text += "; class {" + text_of(same) + "}";
    if (!one.suspected.empty()) text += "; suspected " + text_of(one.suspected);
    if (!one.before.empty()) text += "; before " + one.before;
    if (!one.failed.empty()) text += "; " + one.failed;
    text += "\n";
  }
  return text;
}

}  // namespace offnominal::bench
