#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "command/recordings.hpp"
#include "common/number.hpp"
#include "common/numeric_options.hpp"
#include "common/shell_word.hpp"
#include "compare/filter_plan.hpp"
#include "log/read_log.hpp"

// Options that several verbs have, the same for each.

namespace offnominal::desk {

/// --cutoff and --decimate, of every verb that filters a recording.
inline void add_filter_options(CLI::App& verb, FilterRequest& request) {
  verb.add_option(
      "--cutoff", request.cutoff_hz,
      "Cut-off of the positions' low-pass, Hz; the torques' is the same, or what --decimate lets "
      "pass. Default, as of every verb: torques at 8 to 12 Hz by the encoders, positions at 2.5 "
      "times that");
  verb.add_option("--decimate", request.decimate,
                  "Keep one sample of so many. Default: 2.5 times the torques' cut-off are left a "
                  "second, or 100 where --cutoff is given");
}

// Of the verbs that run a monitor.
inline void add_observe_option(CLI::App& verb, bool& observe_velocity) {
  verb.add_flag("--observe-velocity", observe_velocity,
                "As a controller judges whose drives send positions alone: velocities observed of "
                "positions up to now, whatever was recorded, and positions and torques of the same "
                "time. Without it velocities are those that were recorded; of joints without one "
                "they are made of positions before and after the sample, which no controller has");
}

/// --channels, --period and --payload; `whose`: "recording's" or "recordings'".
inline void add_channels_option(CLI::App& verb, ChannelOptions& channels,
                                const std::string& whose) {
  verb.add_option_function<std::vector<std::string>>(
          "--payload",
          [&verb, &channels](const std::vector<std::string>& texts) {
            channels.payloads = payloads_of(verb.get_name(), texts);
          },
          "What the robot carried in a recording, a point mass in kg at that place in the last "
          "link's frame, m. Once for each recording")
      ->type_name("LOG=KG@X,Y,Z")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false);
  verb.add_option(
      "--channels", channels.file,
      "TOML file that maps the " + whose + " columns, instead of the robot file's [channels]");
  verb.add_option("--period", channels.period_s,
                  "Time between two samples, s, instead of a column of time")
      ->check(above_zero());
}

/// " --channels c.toml --period 0.001": what every command has to be given that reads the same
/// recordings, beside --payload, which is of one of them; empty where nothing was given.
inline std::string reading_words(const ChannelOptions& channels) {
  std::string words;
  if (channels.file) words += " --channels " + shell_word(channels.file->string());
  if (channels.period_s) words += " --period " + shortest(*channels.period_s);
  return words;
}

/// --threads, by default as many as the machine has.
inline void add_threads_option(CLI::App& verb, int& threads, const std::string& words = "Threads") {
  threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  verb.add_option("--threads", threads, words + "; the result does not depend on their number")
      ->check(CLI::Range(1, 256));
}

}  // namespace offnominal::desk
