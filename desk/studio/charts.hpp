#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "report/page.hpp"
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
  // Over it another recording, from 0, laid so that both begin together; none: it alone.
  std::optional<std::size_t> beside = {};
};

/// That the document of the API allows.
inline constexpr std::size_t kMostPixels = 8000;

/// Throws Refused unless both are there or none, and `from_s` before `to_s`.
void check_shown(const std::optional<double>& from_s, const std::optional<double>& to_s);
/// Throws Refused where there is no such joint or recording, or as check_shown().
void check(const Workbench& bench, const View& view);

/// The charts of a joint, as report pages hold them (report/page.hpp): torque over time, error over
/// time, error over velocity, error over position, of the model `now`. Curves over time keep the
/// lowest and the highest point of every pixel of the part that is shown, and of the parts beside
/// it; of that part the points of the others are marked, where a sample lies in it. Throws as
/// check(). `spans` are marked over time.
nlohmann::json charts_of(const Workbench& bench, const Compared& now, const View& view,
                         const std::vector<report::SpanMark>& spans = {});
/// The error of a joint, step by step.
nlohmann::json waterfall_of(const Workbench& bench, std::size_t joint);

/// What fitted and held-out data are called and how they are coloured, in every chart.
struct Role {
  const char* name;
  report::Tone tone;
};
inline constexpr Role kFitted{"fitted data", report::Tone::kModel};
inline constexpr Role kHeldOut{"held-out data", report::Tone::kResidual};
[[nodiscard]] const Role& role_of(const Workbench& bench, std::size_t recording);

/// The samples of a recording in the part of the time that is shown.
struct Shown {
  Eigen::Index first = 0;
  Eigen::Index count = 0;
};
[[nodiscard]] Shown shown_of(const Comparison& recording, const View& view);

/// "Coulomb friction" of "coulomb_friction": as the page calls an effect.
[[nodiscard]] std::string effect_title(const char* name);

/// A cloud of points.
[[nodiscard]] report::Series points_of(const std::string& name, report::Tone tone,
                                       const Eigen::VectorXd& x, const Eigen::VectorXd& y);

/// As a report page holds it.
[[nodiscard]] nlohmann::json block_of(report::Block block);

}  // namespace offnominal::desk::studio
