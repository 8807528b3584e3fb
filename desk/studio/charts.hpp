#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

/// What is looked at.
struct View {
  std::size_t joint = 0;      // from 0
  std::size_t recording = 0;  // from 0, the fitted ones first
  std::size_t pixels = 1000;  // that a chart over time is wide
  // The part of the time that is shown, s of the recording's own time; none: all of it.
  std::optional<double> from_s = {};
  std::optional<double> to_s = {};
};

inline constexpr std::size_t kFewestPixels = 100;
inline constexpr std::size_t kMostPixels = 8000;

/// The charts of a joint, as report pages hold them (report/page.hpp): torque over time, error over
/// time, error over velocity, error over position. Curves over time keep the lowest and the highest
/// point of every pixel of the part that is shown, and of the parts beside it. Throws Refused where
/// there is no such joint, recording or size.
nlohmann::json charts_of(const Workbench& bench, const View& view);
/// The charts over time alone: what a zoom changes.
nlohmann::json time_charts_of(const Workbench& bench, const View& view);
/// The error of a joint, step by step.
nlohmann::json waterfall_of(const Workbench& bench, std::size_t joint);

}  // namespace offnominal::desk::studio
