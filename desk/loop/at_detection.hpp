// What a controller does beyond the second level, as options and scenario files say it.
#pragma once

#include <CLI/CLI.hpp>
#include <offnominal/controller/controller_config.hpp>
#include <optional>
#include <string>
#include <vector>

namespace offnominal::desk {

// How long slowing may take, s: in less the torque would jump, for more it would be none.
inline constexpr double kShortestSlowingS = 0.01;
inline constexpr double kLongestSlowingS = 600;
// Share of its pace that may be left of a slowed motion: of more it would not be one.
inline constexpr double kMostPace = 0.99;

struct ActSettings {
  controller::AtDetection at_detection = controller::AtDetection::kReport;
  SlowDownConfig<double> slow_down;  // of AtDetection::kSlow
};

/// "to 25 % of its pace within 1 s", "to a stand within 1 s".
[[nodiscard]] std::string slowing_words(const SlowDownConfig<double>& slow_down);

/// "report", "slow", "stop": in the order of AtDetection.
[[nodiscard]] const std::vector<std::string>& at_detection_names();
[[nodiscard]] const std::string& name_of(controller::AtDetection at_detection);

/// --at-detection, --slow-to and --slow-within.
struct ActOptions {
  std::optional<std::string> at_detection;
  std::optional<double> slow_to;
  std::optional<double> slow_within_s;
};
void add_act_options(CLI::App& app, ActOptions& options);

/// What was given, over what `settings` say. Throws InputError, in the name of `program`, for a
/// pace where nothing is slowed.
void put_act_options(const std::string& program, const ActOptions& options, ActSettings& settings);

/// The same options as words, for a program that is started.
[[nodiscard]] std::vector<std::string> act_arguments(const ActSettings& settings);

}  // namespace offnominal::desk
