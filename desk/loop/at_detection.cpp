#include "loop/at_detection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "common/error.hpp"
#include "common/number.hpp"

namespace offnominal::desk {

using controller::AtDetection;

const std::vector<std::string>& at_detection_names() {
  static const std::vector<std::string> names = {"report", "slow", "stop"};
  return names;
}

const std::string& name_of(AtDetection at_detection) {
  return at_detection_names().at(static_cast<std::size_t>(at_detection));
}

std::string slowing_words(const SlowDownConfig<double>& slow_down) {
  const std::string pace =
      slow_down.to > 0 ? fmt::format("{:.3g} % of its pace", 100 * slow_down.to) : "a stand";
  return fmt::format("to {} within {:g} s", pace, slow_down.within_s);
}

void add_act_options(CLI::App& app, ActOptions& options) {
  app.add_option(
         "--at-detection", options.at_detection,
         "What follows when a threshold is crossed, with act_ratio in the robot file when it "
         "is crossed by so much: report; slow, the motion goes on at --slow-to of its pace; "
         "stop, the safe state [report]")
      ->check(CLI::IsMember(at_detection_names()));
  app.add_option("--slow-to", options.slow_to,
                 "With --at-detection slow: the share of its pace that the motion is slowed to; 0: "
                 "it comes to a stand on its path [0.25]")
      ->check(CLI::Range(0.0, kMostPace));
  app.add_option("--slow-within", options.slow_within_s,
                 "With --at-detection slow: how long that takes, s [1]")
      ->check(CLI::Range(kShortestSlowingS, kLongestSlowingS));
}

void put_act_options(const std::string& program, const ActOptions& options, ActSettings& settings) {
  if (options.at_detection) {
    const std::vector<std::string>& names = at_detection_names();
    const auto found = std::find(names.begin(), names.end(), *options.at_detection);
    settings.at_detection = static_cast<AtDetection>(found - names.begin());
  }
  if (settings.at_detection != AtDetection::kSlow && (options.slow_to || options.slow_within_s)) {
    throw InputError({program, options.slow_to ? "--slow-to" : "--slow-within",
                      "with --at-detection " + name_of(settings.at_detection),
                      "with --at-detection slow, which it is of",
                      "give --at-detection slow, or leave it out"});
  }
  settings.slow_down.to = options.slow_to.value_or(settings.slow_down.to);
  settings.slow_down.within_s = options.slow_within_s.value_or(settings.slow_down.within_s);
}

std::vector<std::string> act_arguments(const ActSettings& settings) {
  std::vector<std::string> words = {"--at-detection", name_of(settings.at_detection)};
  if (settings.at_detection != AtDetection::kSlow) return words;
  words.insert(words.end(), {"--slow-to", shortest(settings.slow_down.to), "--slow-within",
                             shortest(settings.slow_down.within_s)});
  return words;
}

}  // namespace offnominal::desk
