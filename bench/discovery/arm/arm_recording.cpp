#include "arm_recording.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <numbers>

namespace offnominal::bench {

using Eigen::Index;

namespace {

std::string header_of(const ArmLogStyle& style, Index count) {
  std::string text = "t";
  for (const std::string_view quantity : {"q", "dq", "tau"}) {
    if (quantity == "dq" && !style.logs_velocity) continue;
    for (Index j = 1; j <= count; ++j) text += fmt::format(",{}{}", quantity, j);
  }
  return text + '\n';
}

}  // namespace

std::string recording_text(const ArmRun& run, const ArmLogStyle& style,
                           const std::vector<double>& noise_nm, sim::hidden::Draws& noise) {
  const Index count = run.q.cols();
  const double step = 2 * std::numbers::pi / std::exp2(style.bits);
  std::string text = header_of(style, count);
  const auto out = std::back_inserter(text);
  for (Index row = 0; row < run.t_s.size(); ++row) {
    fmt::format_to(out, "{:.3f}", run.t_s[row]);
    for (Index j = 0; j < count; ++j) {
      if (style.has_five_digits) {
        fmt::format_to(out, ",{:.5g}", run.q(row, j));
      } else {
        fmt::format_to(out, ",{:.8g}", std::round(run.q(row, j) / step) * step);
      }
    }
    for (Index j = 0; style.logs_velocity && j < count; ++j) {
      fmt::format_to(out, ",{:.5g}", run.dq(row, j));
    }
    for (Index j = 0; j < count; ++j) {
      const double sigma = noise_nm.at(static_cast<std::size_t>(j));
      fmt::format_to(out, ",{:.5g}", run.tau(row, j) + sigma * noise.gaussian());
    }
    text += '\n';
  }
  return text;
}

}  // namespace offnominal::bench
