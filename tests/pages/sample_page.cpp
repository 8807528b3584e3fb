// Writes a page that holds every kind of block, from synthetic data: sample_page FILE.html
#include <cmath>
#include <cstdint>
#include <exception>
#include <iostream>
#include <limits>

#include "report/page.hpp"

namespace {

using namespace offnominal::desk::report;

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

/// Repeatable noise in [-1, 1], the same on every machine.
class Noise {
 public:
  double next() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 40) / static_cast<double>(1ULL << 23) - 1.0;
  }

 private:
  std::uint64_t state_ = 7;
};

struct Recording {
  std::vector<double> time, measured, model, residual, threshold, velocity, position;
};

Recording recording() {
  Recording r;
  Noise noise;
  for (int i = 0; i < 20000; ++i) {
    const double t = 0.001 * i;
    const double velocity = 0.36 * std::cos(2.0 * t);
    const double fault = t < 10.0 ? 0.0 : 1.4 * (1.0 - std::exp(-0.5 * (t - 10.0)));
    const double friction = 0.6 * std::tanh(velocity / 0.02) + 0.4 * velocity;
    r.time.push_back(t);
    r.velocity.push_back(velocity);
    r.position.push_back(0.18 * std::sin(2.0 * t));
    r.model.push_back(6.0 * std::cos(r.position.back()) - 3.0 * std::sin(2.0 * t));
    const bool lost = t > 6.2 && t < 6.5;
    r.measured.push_back(lost ? kGap : r.model.back() + friction - fault + 0.08 * noise.next());
    r.residual.push_back(lost ? kGap : std::abs(0.05 * friction + 0.5 * fault) + 0.01);
    r.threshold.push_back(0.12 + 0.06 * std::abs(std::cos(2.0 * t)));
  }
  return r;
}

Chart torque_chart(const Recording& r) {
  Chart chart;
  chart.title = "Joint 1: measured and model torque";
  chart.x = {.name = "Time", .unit = "s"};
  chart.y = {{.name = "Torque", .unit = "Nm"}, {.name = "Velocity", .unit = "rad/s"}};
  chart.series = {{.name = "measured", .x = r.time, .y = r.measured, .tone = Tone::kMeasured},
                  {.name = "model", .x = r.time, .y = r.model, .tone = Tone::kModel},
                  {.name = "velocity",
                   .x = r.time,
                   .y = r.velocity,

                   .tone = Tone::kFaint,
                   .y_axis = 1}};
  chart.events = {{10.0, "fault", Level::kNeutral}, {10.6, "detected", Level::kGood}};
  chart.zoom_group = "time";
  chart.slider = true;
  chart.note = "No sample between 6.2 s and 6.5 s.";
  return chart;
}

Chart residual_chart(const Recording& r) {
  Chart chart;
  chart.title = "Joint 1: residual and threshold";
  chart.x = {.name = "Time", .unit = "s"};
  chart.y = {{.name = "Velocity estimation error", .unit = "rad/s"}};
  Series uncertainty{.name = "95 % interval",
                     .kind = SeriesKind::kBand,
                     .x = {},
                     .y = {},

                     .tone = Tone::kResidual};
  for (std::size_t i = 0; i < r.time.size(); i += 100) {
    uncertainty.x.push_back(r.time[i]);
    uncertainty.y.push_back(r.residual[i] - 0.05);
    uncertainty.y_upper.push_back(r.residual[i] + 0.05);
  }
  chart.series = {uncertainty,
                  {.name = "|e|", .x = r.time, .y = r.residual, .tone = Tone::kResidual},
                  {.name = "threshold \u00b5",
                   .x = r.time,
                   .y = r.threshold,

                   .tone = Tone::kThreshold},
                  {.name = "alarm (latched)",
                   .kind = SeriesKind::kSteps,
                   .x = {0.0, 10.6, 19.999},
                   .y = {0.0, 0.5, 0.5},

                   .tone = Tone::kFaint}};
  chart.events = {{10.0, "fault", Level::kNeutral}, {10.6, "detected", Level::kGood}};
  chart.zoom_group = "time";
  return chart;
}

Chart scatter_chart(const Recording& r) {
  Chart chart;
  chart.title = "Residual torque against velocity";
  chart.x = {.name = "Velocity", .unit = "rad/s"};
  chart.y = {{.name = "Residual torque", .unit = "Nm"}};
  Series points{
      .name = "before 10 s",
      .kind = SeriesKind::kPoints,
      .x = {},
      .y = {},
  };
  for (std::size_t i = 0; i < 10000; ++i) {
    points.x.push_back(r.velocity[i]);
    points.y.push_back(r.measured[i] - r.model[i]);
  }
  chart.series = {points};
  chart.levels = {{0.0, "no residual"}};
  chart.width = Width::kHalf;
  return chart;
}

Chart histogram_chart(const Recording& r) {
  Chart chart;
  chart.title = "Distribution of the residual";
  chart.x = {.name = "Residual torque", .unit = "Nm"};
  chart.y = {{.name = "Samples", .unit = "1"}};
  Series bars{.name = "residual",
              .kind = SeriesKind::kBars,
              .x = {},
              .y = {},

              .tone = Tone::kResidual};
  constexpr int kBins = 40;
  for (int i = 0; i <= kBins; ++i) bars.x.push_back(-2.5 + 4.0 * i / kBins);
  bars.y.assign(kBins, 0.0);
  for (std::size_t i = 0; i < r.time.size(); ++i) {
    const double bin = std::floor((r.measured[i] - r.model[i] + 2.5) * kBins / 4.0);
    if (bin >= 0.0 && bin < kBins) bars.y[static_cast<std::size_t>(bin)] += 1.0;
  }
  chart.series = {bars};
  chart.width = Width::kHalf;
  return chart;
}

Heatmap residual_map() {
  Heatmap map;
  map.title = "Residual over position and velocity";
  map.x = {.name = "Position", .unit = "rad"};
  map.y = {.name = "Velocity", .unit = "rad/s"};
  map.value_axis = {.name = "Mean residual torque", .unit = "Nm"};
  for (int i = 0; i <= 24; ++i) map.x_edges.push_back(-0.18 + 0.015 * i);
  for (int i = 0; i <= 18; ++i) map.y_edges.push_back(-0.36 + 0.04 * i);
  for (int row = 0; row < 18; ++row) {
    for (int column = 0; column < 24; ++column) {
      const double q = -0.1725 + 0.015 * column;
      const double dq = -0.34 + 0.04 * row;
      const double radius = q * q / 0.0324 + dq * dq / 0.1296;
      map.value.push_back(radius > 1.1 ? kGap
                                       : 0.6 * std::tanh(dq / 0.05) + 0.3 * std::sin(20 * q));
    }
  }
  map.diverging = true;
  return map;
}

Heatmap count_map() {
  Heatmap map = residual_map();
  map.title = "Samples per cell";
  map.value_axis = {.name = "Samples", .unit = "1"};
  map.diverging = false;
  double count = 0.0;
  for (double& value : map.value) {
    count += 13.0;
    if (!std::isnan(value)) value = std::fmod(count, 371.0);
  }
  return map;
}

Chart sweep_chart() {
  Chart chart;
  chart.title = "Detection time against mass loss";
  chart.x = {.name = "Mass loss", .unit = "%"};
  chart.y = {{.name = "Time from fault to detection", .unit = "s", .log = true}};
  Series steps{
      .name = "abrupt",
      .x = {},
      .y = {},
  };
  Series slow{
      .name = "incipient, \u03c1 = 0.5 1/s",
      .x = {},
      .y = {},
  };
  for (int i = 1; i <= 9; ++i) {
    steps.x.push_back(10.0 * i);
    steps.y.push_back(0.9 / (i * i));
    slow.x.push_back(10.0 * i);
    slow.y.push_back(9.0 / i);
  }
  chart.series = {steps, slow};
  chart.levels = {{0.6, "paper: 0.6 s"}};
  chart.width = Width::kHalf;
  return chart;
}

Chart order_chart() {
  Chart chart;
  chart.title = "Order spectrum of the residual";
  chart.x = {.name = "Order", .unit = "1/turn"};
  chart.y = {{.name = "Amplitude", .unit = "Nm"}};
  Series spectrum{.name = "amplitude", .x = {}, .y = {}, .tone = Tone::kModel};
  for (int i = 0; i <= 800; ++i) {
    const double order = 0.1 * i;
    double amplitude = 0.004;
    for (const double pole : {12.0, 18.0, 72.0}) {
      amplitude += 0.1 / (1.0 + 60.0 * (order - pole) * (order - pole));
    }
    spectrum.x.push_back(order);
    spectrum.y.push_back(amplitude);
  }
  chart.series = {spectrum};
  chart.events = {{12.0, "slots"}, {18.0, "2 x poles"}, {72.0, "order 72", Level::kWarn}};
  chart.width = Width::kHalf;
  return chart;
}

Waterfall error_waterfall() {
  Waterfall waterfall;
  waterfall.title = "Relative force error on the hold-out recording";
  waterfall.value_axis = {.name = "Relative error", .unit = "%"};
  waterfall.steps = {{"inertia only", 69.41},
                     {"+ viscous friction", 17.02},
                     {"+ Coulomb friction, offset", 5.98},
                     {"+ screw-pitch ripple (rejected)", 6.31},
                     {"+ friction asymmetry", 5.34}};
  waterfall.levels = {{5.982, "published 5.982 %"}};
  waterfall.format = ".2f";
  return waterfall;
}

Table coefficients() {
  return {"Fitted parameters of joint 1",
          {{"Parameter", ""},
           {"Value", "SI", ".4f"},
           {"95 % interval, half width", "SI", ".1e"},
           {"Share of torque", "%", ".1f"},
           {"Verdict", ""}},
          {{"mass M", 95.1089, 0.12, 70.2, "kept"},
           {"viscous_friction", 203.5034, 1.4, 17.9, "kept"},
           {"coulomb_friction", 20.3935, 0.31, 10.4, "kept"},
           {"friction_asymmetry", -3.1648, 0.22, 1.5, "kept"},
           {"<b>cogging</b> & \"ripple\"", 0.0012, kGap, std::monostate{}, "not seen"}},
          "Interval from the block bootstrap, 200 resamples."};
}

Page sample() {
  const Recording r = recording();
  KeyFigures figures;
  figures.figures = {
      {"Detection time", 10.6, "s", ".2f", Level::kGood, "paper: 10.6 s"},
      {"Relative torque error", 4.083, "%", ".2f", Level::kNeutral, "published: 4.083 %"},
      {"Largest |e|/\u00b5 before the fault", 0.834, "1", ".3f", Level::kNeutral,
       "must stay below 1"},
      {"Stale samples", 300.0, "1", "d", Level::kWarn, "between 6.2 s and 6.5 s"},
      {"Alarm", "latched", "", kDefaultFormat, Level::kBad, "since 10.6 s"}};
  Page page;
  page.title = "Two-link arm: loss of mass at link 1";
  page.subtitle = "75 % of the mass lost at 10 s, slowly (\u03c1 = 0.5 1/s), L = 35 hidden units";
  page.verdict = {
      "The fault at 10 s is detected at 10.6 s, as in the paper. Before it the residual "
      "stays under its threshold.",
      Level::kGood};
  page.sections = {
      {"What was found",
       "Synthetic data. It shows every kind of block </script><!-- once.",
       {figures, coefficients()}},
      {"Over time", "", {torque_chart(r), residual_chart(r)}},
      {"Where the model fails",
       "The residual jumps where the velocity changes its sign.\n\nIt does not depend on position.",
       {scatter_chart(r), histogram_chart(r), residual_map(), count_map()}},
      {"Effect by effect",
       "",
       {error_waterfall(), order_chart(), sweep_chart(),
        Note{"The recording lacks plateaus at low speed: Stribeck friction cannot be told from "
             "Coulomb friction.",
             Level::kWarn},
        Note{"All numbers of this page are in the JSON that it embeds."}}}};
  for (const char* name : {"speed_1.csv", "speed_2.csv, 30 to 64 s (held out)"}) {
    Chart chart = residual_chart(r);
    chart.title = "Residual of the recording";
    Section of_one{"Joint 1", name, {chart}};
    of_one.recording = name;
    page.sections.push_back(std::move(of_one));
  }
  page.command_line = "offnominal paper --fault mass_loss --report sample.html";
  return page;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::cerr << "usage: sample_page FILE.html\n";
    return 2;
  }
  write_page(argv[1], sample(), offnominal::desk::Existing::kReplace);
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 2;
}
