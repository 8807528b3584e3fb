#pragma once

#include <CLI/CLI.hpp>

#include "analysis/filter_plan.hpp"

namespace offnominal::tools {

/// --cutoff and --decimate, the same for every verb that filters a recording.
inline void add_filter_options(CLI::App& verb, FilterRequest& request) {
  verb.add_option(
      "--cutoff", request.cutoff_hz,
      "Cut-off of the low-pass, Hz. Default: 100, or a quarter of a sampling rate below "
      "400 Hz");
  verb.add_option("--decimate", request.decimate,
                  "Keep one sample of so many. Default: about 100 samples a second are left");
}

}  // namespace offnominal::tools
