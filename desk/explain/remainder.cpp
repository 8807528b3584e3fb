#include "explain/remainder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr int kFolds = 5;
constexpr Index kBins = 24;
constexpr Index kMapBins = 8;

// Power of a signal at a frequency, per hertz.
double density_at(const VectorXd& signal, double period_s, double frequency_hz) {
  const double step = 2 * std::numbers::pi * frequency_hz * period_s;
  double in = 0;
  double quadrature = 0;
  double c = 1;
  double s = 0;
  const double dc = std::cos(step);
  const double ds = std::sin(step);
  for (const double value : signal) {
    in += value * c;
    quadrature += value * s;
    const double turned = c * dc - s * ds;
    s = s * dc + c * ds;
    c = turned;
  }
  return 2 * (in * in + quadrature * quadrature) * period_s / static_cast<double>(signal.size());
}

// The bin of every value among `bins` equally filled ones.
std::vector<Index> equally_filled(const VectorXd& values, Index bins) {
  std::vector<Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return values[a] < values[b]; });
  std::vector<Index> bin(order.size());
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    bin[static_cast<std::size_t>(order[rank])] = static_cast<Index>(rank) * bins / values.size();
  }
  return bin;
}

// One joint of all recordings, one sample after the other.
struct JointSeries {
  VectorXd residual, q, dq, load, t_s;
  std::vector<int> fold;
};

JointSeries series_of(const Data& data, const VectorXd& residual, Index joint) {
  const RowLayout& layout = data.layout;
  Index count = 0;
  for (std::size_t r = 0; r < layout.recording_count(); ++r) count += layout.samples(r);
  JointSeries series{VectorXd(count), VectorXd(count),
                     VectorXd(count), VectorXd(count),
                     VectorXd(count), std::vector<int>(static_cast<std::size_t>(count))};
  constexpr double kFoldBlockS = 0.5;
  Index at = 0;
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    const Workspace& recording = data.recordings[r];
    const Index n = layout.samples(r);
    series.residual.segment(at, n) = residual.segment(layout.begin(r, joint), n);
    series.q.segment(at, n) = kept_samples(recording.plan, recording.motion.q.col(joint));
    series.dq.segment(at, n) = kept_samples(recording.plan, recording.motion.dq.col(joint));
    series.load.segment(at, n) = kept_samples(recording.plan, recording.load_torque.col(joint));
    series.t_s.segment(at, n) = kept_samples(recording.plan, recording.motion.t_s);
    for (Index i = 0; i < n; ++i) {
      const auto block =
          static_cast<int>(static_cast<double>(i) * layout.period_s(r) / kFoldBlockS);
      series.fold[static_cast<std::size_t>(at + i)] = block % kFolds;
    }
    at += n;
  }
  return series;
}

// Share of the energy that the means over bins of the other folds explain.
double held_out_share(const VectorXd& values, const std::vector<Index>& bin, Index bins,
                      const std::vector<int>& fold) {
  const double mean = values.mean();
  double left = 0;
  double whole = 0;
  for (int f = 0; f < kFolds; ++f) {
    VectorXd sum = VectorXd::Zero(bins);
    VectorXd count = VectorXd::Zero(bins);
    for (Index i = 0; i < values.size(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (fold[at] == f) continue;
      sum[bin[at]] += values[i] - mean;
      count[bin[at]] += 1;
    }
    for (Index i = 0; i < values.size(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (fold[at] != f) continue;
      const double expected = count[bin[at]] > 0 ? sum[bin[at]] / count[bin[at]] : 0;
      left += std::pow(values[i] - mean - expected, 2);
      whole += std::pow(values[i] - mean, 2);
    }
  }
  return whole > 0 ? std::max(0.0, 1 - left / whole) : 0;
}

// What is concentrated in a few stretches of time, less what an even spread would have there.
double time_share(const JointSeries& series) {
  constexpr double kWindowS = 0.5;
  constexpr double kFewWindows = 0.1;
  std::vector<double> energy;
  double start = series.t_s[0];
  double sum = 0;
  double last = start;
  for (Index i = 0; i < series.t_s.size(); ++i) {
    const double t = series.t_s[i];
    if (t - start >= kWindowS || t < last) {
      energy.push_back(sum);
      sum = 0;
      start = t;
    }
    sum += series.residual[i] * series.residual[i];
    last = t;
  }
  energy.push_back(sum);
  std::sort(energy.begin(), energy.end(), std::greater<>());
  const double whole = std::accumulate(energy.begin(), energy.end(), 0.0);
  if (!(whole > 0)) return 0;
  const auto few = std::max<std::size_t>(
      1, static_cast<std::size_t>(kFewWindows * static_cast<double>(energy.size())));
  const double typical = energy[energy.size() / 2] * static_cast<double>(energy.size());
  const double in_few =
      std::accumulate(energy.begin(), energy.begin() + static_cast<std::ptrdiff_t>(few), 0.0);
  return std::max(0.0, (in_few - typical * kFewWindows) / whole);
}

// Of readings at rest: how far two in a row differ.
VectorXd repeatability_of(const RowLayout& layout, const VectorXd& residual) {
  VectorXd energy = VectorXd::Zero(layout.joint_count());
  double pairs = 0;
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    const Index n = layout.samples(r);
    for (Index joint = 0; joint < layout.joint_count(); ++joint) {
      const auto part = residual.segment(layout.begin(r, joint), n);
      energy[joint] += (part.tail(n - 1) - part.head(n - 1)).squaredNorm() / 2;
    }
    pairs += static_cast<double>(n - 1);
  }
  return (energy / pairs).cwiseSqrt();
}

}  // namespace

VectorXd noise_floor_of(const Data& data, const VectorXd& left) {
  constexpr double kFrom = 0.4;
  constexpr double kTo = 0.75;
  constexpr int kFrequencies = 200;
  const RowLayout& layout = data.layout;
  if (data.recordings[0].at_rest) return repeatability_of(layout, left);
  const VectorXd residual = layout.while_moving(left);
  VectorXd power = VectorXd::Zero(layout.joint_count());
  VectorXd samples = VectorXd::Zero(layout.joint_count());
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    const double cutoff_hz = data.recordings[r].plan.torque_cutoff_hz;
    for (Index joint = 0; joint < layout.joint_count(); ++joint) {
      const VectorXd part = residual.segment(layout.begin(r, joint), layout.samples(r));
      std::vector<double> densities;
      for (int k = 0; k < kFrequencies; ++k) {
        const double f = cutoff_hz * (kFrom + (kTo - kFrom) * k / (kFrequencies - 1));
        densities.push_back(density_at(part, layout.period_s(r), f));
      }
      // The median of exponentially distributed densities is ln 2 times their mean.
      std::nth_element(densities.begin(), densities.begin() + kFrequencies / 2, densities.end());
      power[joint] += static_cast<double>(part.size()) * densities[kFrequencies / 2] /
                      std::numbers::ln2 * cutoff_hz;
      samples[joint] += layout.moving_count(r, joint);
    }
  }
  return power.cwiseQuotient(samples.cwiseMax(1)).cwiseSqrt();
}

const char* name_of(EffectVariable variable) {
  switch (variable) {
    case EffectVariable::kPosition:
      return "position";
    case EffectVariable::kVelocity:
      return "velocity";
    case EffectVariable::kLoad:
      return "load";
    case EffectVariable::kNone:
      break;
  }
  return "";
}

double share_of(const std::vector<StructureShare>& shares, Index joint, std::string_view variable) {
  for (const StructureShare& one : shares) {
    if (one.joint == joint && one.variable == variable) return one.share;
  }
  return 0;
}

std::vector<StructureShare> structure_of(const Data& data, const VectorXd& left) {
  const VectorXd residual = data.layout.while_moving(left);
  std::vector<StructureShare> shares;
  for (Index joint = 0; joint < data.layout.joint_count(); ++joint) {
    const JointSeries series = series_of(data, residual, joint);
    const auto add = [&](const char* variable, const std::vector<Index>& bin, Index bins) {
      shares.push_back({joint, variable, held_out_share(series.residual, bin, bins, series.fold)});
    };
    const std::vector<Index> q = equally_filled(series.q, kBins);
    add("position", q, kBins);
    if (data.recordings[0].at_rest) continue;
    add("velocity", equally_filled(series.dq, kBins), kBins);
    add("load", equally_filled(series.load, kBins), kBins);
    std::vector<Index> map = equally_filled(series.q, kMapBins);
    const std::vector<Index> dq = equally_filled(series.dq, kMapBins);
    for (std::size_t i = 0; i < map.size(); ++i) map[i] = map[i] * kMapBins + dq[i];
    add("position and velocity", map, kMapBins * kMapBins);
    shares.push_back({joint, "time", time_share(series)});
  }
  std::stable_sort(
      shares.begin(), shares.end(),
      [](const StructureShare& a, const StructureShare& b) { return a.share > b.share; });
  return shares;
}

namespace {

const VectorXd& variable_of(const JointSeries& series, const std::string& variable) {
  return variable == "velocity" ? series.dq : variable == "load" ? series.load : series.q;
}

}  // namespace

Eigen::MatrixXd bins_over(const Data& data, Index joint, const std::string& variable) {
  const RowLayout& layout = data.layout;
  const JointSeries series = series_of(data, VectorXd::Zero(layout.rows()), joint);
  const std::vector<Index> bin = equally_filled(variable_of(series, variable), kBins);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(layout.rows(), kBins);
  std::size_t at = 0;
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    for (Index i = 0; i < layout.samples(r); ++i) {
      columns(layout.begin(r, joint) + i, bin[at++]) = 1;
    }
  }
  return columns;
}

MapOver map_over(const Data& data, const VectorXd& left, Index joint, const std::string& variable) {
  const JointSeries series = series_of(data, data.layout.while_moving(left), joint);
  const VectorXd& over = variable_of(series, variable);
  const std::vector<Index> bin = equally_filled(over, kBins);
  std::vector<double> count(static_cast<std::size_t>(kBins), 0);
  MapOver map{std::vector<double>(count.size(), 0), std::vector<double>(count.size(), 0)};
  for (Index i = 0; i < over.size(); ++i) {
    const auto to = static_cast<std::size_t>(bin[static_cast<std::size_t>(i)]);
    count[to] += 1;
    map.at[to] += over[i];
    map.mean[to] += series.residual[i];
  }
  for (std::size_t i = 0; i < count.size(); ++i) {
    map.at[i] /= std::max(1.0, count[i]);
    map.mean[i] /= std::max(1.0, count[i]);
  }
  return map;
}

namespace {

// Where between `low` and `high` the power of the samples changes, by the likelihood of two levels
// clearly above that of one: the first sample of the second one. `quiet`: power that tells nothing.
std::optional<Index> step_of_power(const Eigen::Ref<const VectorXd>& values, Index low, Index high,
                                   double quiet) {
  constexpr double kTold = 8;
  const Index count = high - low;
  if (count < 4) return std::nullopt;
  VectorXd sum = VectorXd::Zero(count + 1);
  for (Index i = 0; i < count; ++i) sum[i + 1] = sum[i] + values[low + i] * values[low + i];
  const double floor = 0.1 * quiet + 1e-300;
  const auto level = [&](double energy, double samples) {
    return -samples * std::log(energy / samples + floor);
  };
  std::optional<Index> best;
  double most = level(sum[count], static_cast<double>(count)) + kTold;
  for (Index i = 2; i + 2 <= count; ++i) {
    const auto before = static_cast<double>(i);
    const auto after = static_cast<double>(count - i);
    const double likely = level(sum[i], before) + level(sum[count] - sum[i], after);
    if (likely <= most) continue;
    most = likely;
    best = low + i;
  }
  return best;
}

// Samples of one recording, `count` from `first` on.
struct LoudSamples {
  Index first = 0;
  Index count = 0;
};

// Its first and last sample, to the sample, where it was found in whole windows: each end is looked
// for from a window outside to the middle, and stays where none is to be seen or the recording has
// one.
LoudSamples sharpened(const LoudSamples& rough, const Eigen::Ref<const VectorXd>& values,
                      Index window, double quiet) {
  const Index middle = rough.first + rough.count / 2;
  const Index low = std::max<Index>(0, rough.first - window);
  const Index high = std::min(values.size(), rough.first + rough.count + window);
  const Index rough_end = rough.first + rough.count;
  Index first = rough.first;
  Index end = rough_end;
  if (rough.first > 0) first = step_of_power(values, low, middle, quiet).value_or(first);
  if (rough_end < values.size()) end = step_of_power(values, middle, high, quiet).value_or(end);
  return {first, std::max<Index>(1, end - first)};
}

}  // namespace

std::vector<LoudWindow> loud_windows(const Data& data, const VectorXd& left, Index joint) {
  constexpr double kWindowS = 0.5;
  constexpr double kLoudest = 0.1;
  constexpr double kAboveMedian = 4;
  const RowLayout& layout = data.layout;
  const VectorXd residual = layout.while_moving(left);
  struct Window {
    std::size_t recording = 0;
    LoudSamples samples;
    double power = 0;
  };
  std::vector<Window> windows;
  const auto length_in = [&](std::size_t r) {
    return std::max<Index>(1, std::lround(kWindowS / layout.period_s(r)));
  };
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    for (Index first = 0; first < layout.samples(r); first += length_in(r)) {
      const Index count = std::min(length_in(r), layout.samples(r) - first);
      const auto part = residual.segment(layout.begin(r, joint) + first, count);
      windows.push_back({r, {first, count}, part.squaredNorm() / static_cast<double>(count)});
    }
  }
  std::vector<double> powers;
  for (const Window& one : windows) powers.push_back(one.power);
  std::sort(powers.begin(), powers.end());
  const auto at = [&](double share) {
    return powers[static_cast<std::size_t>(share * static_cast<double>(powers.size() - 1))];
  };
  const double least = std::max(at(1 - kLoudest), kAboveMedian * at(0.5));
  std::vector<Window> loud;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    if (!(windows[i].power >= least) || !(windows[i].power > 0)) continue;
    const bool joins = i > 0 && !loud.empty() && windows[i - 1].power >= least &&
                       loud.back().recording == windows[i].recording;
    if (joins) {
      loud.back().samples.count += windows[i].samples.count;
    } else {
      loud.push_back(windows[i]);
    }
  }
  std::vector<LoudWindow> all;
  for (const Window& one : loud) {
    const std::size_t r = one.recording;
    const VectorXd t_s = kept_samples(data.recordings[r].plan, data.recordings[r].motion.t_s);
    const auto own = residual.segment(layout.begin(r, joint), layout.samples(r));
    const LoudSamples ends = sharpened(one.samples, own, length_in(r), at(0.5));
    all.push_back({r, t_s[ends.first], t_s[ends.first + ends.count - 1]});
  }
  return all;
}

}  // namespace offnominal::desk
