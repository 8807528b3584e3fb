#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/amount.hpp"
#include "common/text_table.hpp"
#include "tune/tune.hpp"

namespace offnominal::desk {
namespace {

const char* mark(bool chosen) { return chosen ? "*" : " "; }

// Of a filter's pole: the estimator's own, or that of the second filter.
const char* mark(const AlphaTrial& trial) {
  if (trial.chosen) return "*";
  return trial.chosen_fast ? "f" : " ";
}

std::string percent(double share) { return fmt::format("{:.1f}", 100 * share); }

std::string alphas_text(const Tuned& tuned, const TuneRequest& request) {
  std::vector<TextColumn> columns{{"", 1}, {"alpha 1/s", 9}, {"soon", 8}, {"mean", 8}};
  for (std::size_t i = 0; i < tuned.units.size(); ++i) {
    columns.push_back({fmt::format("joint {} {}", i + 1, tuned.units[i]), 12});
  }
  const TextTable table(columns, "  ");
  std::string text = fmt::format(
      "Filter: the smallest lasting torque beside the model that is seen within {:g} s, "
      "soon:\nwithin {:g} s; *: chosen, f: for a second filter beside it\n",
      request.within_s, kSoonShare * request.within_s);
  text += table.heading();
  std::string missing;
  for (const AlphaTrial& trial : tuned.alphas) {
    if (!trial.why_none.empty()) {
      missing += fmt::format("  alpha {:g} was not tried: {}\n", trial.alpha_per_s, trial.why_none);
      continue;
    }
    std::vector<std::string> cells{mark(trial), fmt::format("{:g}", trial.alpha_per_s),
                                   significant(trial.mean_soon, 3), significant(trial.mean, 3)};
    for (const double torque : trial.seen_from) cells.push_back(significant(torque, 3));
    text += table.line(cells);
  }
  return text + missing;
}

std::string trials_text(const std::vector<LearningTrial>& trials) {
  const TextTable table({{"", 1},
                         {"hidden units", 12},
                         {"learning rate", 13},
                         {"initial weights", 15},
                         {"missed %", 8},
                         {"weights", 8}},
                        "  ");
  std::string text = table.heading();
  for (const LearningTrial& trial : trials) {
    text +=
        table.row(mark(trial.chosen), trial.hidden_units, fmt::format("{:g}", trial.learning_rate),
                  fmt::format("{:g}", trial.initial_weight_range), percent(trial.missed),
                  significant(trial.weight_norm, 3));
  }
  return text;
}

std::string lines_text(const std::vector<EstimatorLine>& lines) {
  std::string text = "[estimator]\n";
  for (const EstimatorLine& line : lines) text += fmt::format("  {} = {}\n", line.key, line.value);
  return text;
}

nlohmann::ordered_json json_of(const std::vector<LearningTrial>& trials) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const LearningTrial& trial : trials) {
    all.push_back({{"learning_rate", trial.learning_rate},
                   {"hidden_units", trial.hidden_units},
                   {"initial_weight_range", trial.initial_weight_range},
                   {"missed", trial.missed},
                   {"weight_norm", trial.weight_norm},
                   {"chosen", trial.chosen}});
  }
  return all;
}

nlohmann::ordered_json json_of(const std::vector<AlphaTrial>& trials) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const AlphaTrial& trial : trials) {
    nlohmann::ordered_json one{{"alpha_per_s", trial.alpha_per_s},
                               {"chosen", trial.chosen},
                               {"chosen_fast", trial.chosen_fast}};
    if (trial.why_none.empty()) {
      one["seen_from"] = trial.seen_from;
      one["mean"] = trial.mean;
      one["mean_soon"] = trial.mean_soon;
    } else {
      one["not_tried"] = trial.why_none;
    }
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace

std::string text_of(const Tuned& tuned, const TuneRequest& request) {
  std::string torques;
  for (std::size_t i = 0; i < tuned.units.size(); ++i) {
    torques += fmt::format("{}{:g} and {:g} {}", i == 0 ? "" : ", ", tuned.trial_torques[0][i],
                           tuned.trial_torques[1][i], tuned.units[i]);
  }
  std::string text = alphas_text(tuned, request);
  text += fmt::format(
      "\nLearning: on each joint in turn a torque of {} that appears in {:.3g} s of recording, "
      "once "
      "constant, once against the velocity; missed is what the network does not follow of it from "
      "1 s on\nThe robot file's own settings\n{}\nInitial weights\n{}\nLearning rate\n{}\nHidden "
      "units\n{}\n",
      torques, tuned.trial_s, trials_text({tuned.before}), trials_text(tuned.ranges),
      trials_text(tuned.rates), trials_text(tuned.sizes));
  text += lines_text(tuned.lines);
  for (const std::string& note : tuned.notes) text += "note: " + note + "\n";
  for (const std::string& objection : tuned.objections) text += "objection: " + objection + "\n";
  if (tuned.objections.empty()) {
    text += "Next: `offnominal calibrate` on the file that was written, for its bounds.\n";
  }
  return text;
}

nlohmann::ordered_json to_json(const Tuned& tuned, const TuneRequest& request) {
  nlohmann::ordered_json settings;
  for (const EstimatorLine& line : tuned.lines) {
    settings.push_back({{"key", line.key}, {"value", line.value}, {"reason", line.reason}});
  }
  return {{"within_s", request.within_s},
          {"alarms_per_hour", request.alarms_per_hour},
          {"units", tuned.units},
          {"alphas", json_of(tuned.alphas)},
          {"trial_torques", tuned.trial_torques},
          {"trial_s", tuned.trial_s},
          {"before", json_of(std::vector<LearningTrial>{tuned.before})[0]},
          {"initial_weights", json_of(tuned.ranges)},
          {"learning_rates", json_of(tuned.rates)},
          {"network_sizes", json_of(tuned.sizes)},
          {"estimator", std::move(settings)},
          {"notes", tuned.notes},
          {"objections", tuned.objections}};
}

}  // namespace offnominal::desk
