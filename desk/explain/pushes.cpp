#include "explain/pushes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "common/list_of_joints.hpp"
#include "explain/friction_family.hpp"
#include "explain/link_share.hpp"
#include "explain/remainder.hpp"
#include "identify/regression.hpp"
#include "signal/quantile.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Samples of one recording, `count` from `first` on.
struct SampleSpan {
  Index first = 0;
  Index count = 0;
};

// A stretch of the kept samples of one recording that stands out.
struct LoudStretch {
  std::size_t recording = 0;
  SampleSpan samples;

  [[nodiscard]] Index end() const { return samples.first + samples.count; }
  friend bool operator==(const LoudStretch& a, const LoudStretch& b) {
    return a.recording == b.recording && a.samples.first == b.samples.first &&
           a.samples.count == b.samples.count;
  }
};

// Nine tenths of the values stay below it; 0 where there are none.
double usual_of(const std::vector<double>& values) {
  constexpr double kUsual = 0.9;
  if (values.empty()) return 0;
  return quantile(VectorXd::Map(values.data(), static_cast<Index>(values.size())), kUsual);
}

class PushFinder {
 public:
  PushFinder(const Data& data, const RobotDescription& robot,
             const std::vector<Excitation>& excitation)
      : data_(data, robot, beside_unknown_links({})),
        layout_(data_.layout),
        regression_(data_),
        terms_(standard_friction(data_)),
        excitation_(excitation),
        torque_(layout_.rms(data_.torque)) {
    // Far heavier than its link, it is none of what links of another mass do.
    add_payload(regression_, terms_);
  }

  std::vector<Push> run() {
    settle();
    std::vector<LoudStretch> may_be;  // and what is no push for its length or place alone
    std::vector<LoudStretch> rough;
    std::vector<Push> pushes;
    double pushed_s = 0;
    for (const LoudStretch& one : loud_) {
      const LoudStretch sharp = with_sharp_ends(one);
      if (is_long(sharp) || is_at_an_end(sharp)) {
        may_be.push_back(one);
        continue;
      }
      if (is_short(sharp)) continue;
      auto push = push_in(sharp, one);
      if (!push) continue;
      pushed_s += push->to_s - push->from_s;
      may_be.push_back(one);
      rough.push_back(one);
      pushes.push_back(std::move(*push));
    }
    // What happens all the time is no event.
    if (pushed_s > kMostOfTime * recorded_s()) return {};
    loud_ = may_be;
    outside_ = rows_outside();
    const VectorXd otherwise = largest_powers_outside();
    std::vector<Push> all;
    for (std::size_t i = 0; i < pushes.size(); ++i) {
      if (is_largest(rough[i], otherwise)) all.push_back(std::move(pushes[i]));
    }
    return all;
  }

 private:
  static constexpr double kMostOfTime = 0.2;
  // Power, in units of the usual one, from which a joint counts.
  static constexpr double kShows = 2;

  // Fits without what stands out, until that stays as it is: what a push leaves in the fit hides
  // another one until the first is out.
  void settle() {
    constexpr int kTurns = 6;
    fit_outside();
    for (int turn = 0; turn < kTurns; ++turn) {
      std::vector<LoudStretch> now = loud_stretches();
      if (now == loud_) return;
      loud_ = std::move(now);
      fit_outside();
    }
  }

  void fit_outside() {
    outside_ = rows_outside();
    residual_ = regression_.fit(terms_, outside_).residual;
    left_ = layout_.while_moving(residual_);
    measure_powers();
    measure_held();
  }

  [[nodiscard]] double recorded_s() const {
    double sum = 0;
    for (std::size_t r = 0; r < layout_.recording_count(); ++r) {
      sum += static_cast<double>(layout_.samples(r)) * layout_.period_s(r);
    }
    return sum;
  }

  [[nodiscard]] std::vector<char> rows_outside() const {
    std::vector<char> rows(static_cast<std::size_t>(layout_.rows()), 1);
    for (const LoudStretch& one : loud_) mark(one, 0, rows);
    return rows;
  }

  // The rows of a stretch, of all joints.
  void mark(const LoudStretch& one, char value, std::vector<char>& rows) const {
    for (Index joint = 0; joint < layout_.joint_count(); ++joint) {
      std::fill_n(rows.begin() + layout_.begin(one.recording, joint) + one.samples.first,
                  one.samples.count, value);
    }
  }

  [[nodiscard]] Index half_window(std::size_t recording) const {
    constexpr double kHalfWindowS = 0.125;
    return std::max<Index>(1, std::lround(kHalfWindowS / layout_.period_s(recording)));
  }

  // Mean square of a joint's error in the window around every sample.
  [[nodiscard]] VectorXd power_of(std::size_t recording, Index joint) const {
    const Index n = layout_.samples(recording);
    const Index half = half_window(recording);
    const auto own = left_.segment(layout_.begin(recording, joint), n);
    VectorXd sum = VectorXd::Zero(n + 1);
    for (Index i = 0; i < n; ++i) sum[i + 1] = sum[i] + own[i] * own[i];
    VectorXd power(n);
    for (Index i = 0; i < n; ++i) {
      const Index from = std::max<Index>(0, i - half);
      const Index to = std::min(n, i + half + 1);
      power[i] = (sum[to] - sum[from]) / static_cast<double>(to - from);
    }
    return power;
  }

  // Per joint the power that its error stays below nine tenths of the time outside of what stands
  // out already; 0 where it does not move. And how far all joints stand above that at once: sum of
  // logarithms, per sample of every recording.
  void measure_powers() {
    usual_ = VectorXd::Zero(layout_.joint_count());
    standing_out_.clear();
    for (std::size_t r = 0; r < layout_.recording_count(); ++r) {
      standing_out_.emplace_back(VectorXd::Zero(layout_.samples(r)));
    }
    for (Index joint = 0; joint < usual_.size(); ++joint) {
      if (!excitation_[static_cast<std::size_t>(joint)].moves) continue;
      std::vector<VectorXd> powers;
      std::vector<double> counted;
      for (std::size_t r = 0; r < layout_.recording_count(); ++r) {
        powers.push_back(power_of(r, joint));
        for (Index i = 0; i < powers[r].size(); ++i) {
          const Index row = layout_.begin(r, joint) + i;
          if (layout_.says_something(row) && outside_[static_cast<std::size_t>(row)] != 0) {
            counted.push_back(powers[r][i]);
          }
        }
      }
      usual_[joint] = usual_of(counted);
      if (!(usual_[joint] > 0)) continue;
      for (std::size_t r = 0; r < powers.size(); ++r) {
        for (Index i = 0; i < powers[r].size(); ++i) {
          const double times = powers[r][i] / usual_[joint];
          if (times > kShows) standing_out_[r][i] += std::log(times);
        }
      }
    }
  }

  [[nodiscard]] std::vector<LoudStretch> loud_stretches() const {
    constexpr double kStandsOut = 3;
    constexpr double kJoinS = 0.3;
    std::vector<LoudStretch> all;
    for (std::size_t r = 0; r < standing_out_.size(); ++r) {
      const Index half = half_window(r);
      const Index gap = std::lround(kJoinS / layout_.period_s(r));
      for (Index i = 0; i < standing_out_[r].size(); ++i) {
        if (standing_out_[r][i] < kStandsOut) continue;
        const Index first = std::max<Index>(0, i - half);
        const Index end = std::min(standing_out_[r].size(), i + half + 1);
        if (!all.empty() && all.back().recording == r && first <= all.back().end() + gap) {
          all.back().samples.count = end - all.back().samples.first;
        } else {
          all.push_back({r, {first, end - first}});
        }
      }
    }
    return all;
  }

  // Per joint the torque that friction holds it at nine tenths of the time that it stands outside
  // of what stands out; 0 where it never does.
  void measure_held() {
    held_ = VectorXd::Zero(layout_.joint_count());
    for (Index joint = 0; joint < held_.size(); ++joint) {
      std::vector<double> held;
      for (std::size_t r = 0; r < layout_.recording_count(); ++r) {
        const VectorXd stands = standing(r, joint);
        for (Index i = 0; i < stands.size(); ++i) {
          const Index row = layout_.begin(r, joint) + i;
          if (stands[i] > 0 && outside_[static_cast<std::size_t>(row)] != 0) {
            held.push_back(std::abs(residual_[row]));
          }
        }
      }
      held_[joint] = usual_of(held);
    }
  }

  // Per sample 1 where a joint stands, and 0 where it moves or its samples were left out.
  [[nodiscard]] VectorXd standing(std::size_t recording, Index joint) const {
    const Workspace& at = data_.recordings[recording];
    VectorXd stands = VectorXd::Zero(layout_.samples(recording));
    if (at.moving.size() == 0) return stands;
    const VectorXd moving = kept_samples(at.plan, at.moving.col(joint));
    VectorXd usable = VectorXd::Ones(stands.size());
    if (at.usable.size() > 0) usable = kept_samples(at.plan, at.usable.col(joint));
    for (Index i = 0; i < stands.size(); ++i) {
      if (!(moving[i] > 0) && usable[i] > 0) stands[i] = 1;
    }
    return stands;
  }

  // How far all joints stand out together, per sample: where one stands, by what friction does not
  // hold it at.
  [[nodiscard]] VectorXd height_of(std::size_t recording, const SampleSpan& around) const {
    VectorXd power = VectorXd::Zero(around.count);
    for (Index joint = 0; joint < usual_.size(); ++joint) {
      if (!(usual_[joint] > 0)) continue;
      const VectorXd stands = standing(recording, joint);
      for (Index i = 0; i < around.count; ++i) {
        const Index row = layout_.begin(recording, joint) + around.first + i;
        const double holds = held_[joint] * stands[around.first + i];
        const double torque = std::max(0.0, std::abs(residual_[row]) - holds);
        power[i] += torque * torque / usual_[joint];
      }
    }
    return power.cwiseSqrt();
  }

  // Per joint the largest power outside of what may be pushes: what stood out and was none is among
  // it.
  [[nodiscard]] VectorXd largest_powers_outside() const {
    VectorXd largest = VectorXd::Zero(usual_.size());
    for (Index joint = 0; joint < usual_.size(); ++joint) {
      for (std::size_t r = 0; r < layout_.recording_count(); ++r) {
        const VectorXd power = power_of(r, joint);
        for (Index i = 0; i < power.size(); ++i) {
          const Index row = layout_.begin(r, joint) + i;
          if (outside_[static_cast<std::size_t>(row)] == 0) continue;
          largest[joint] = std::max(largest[joint], power[i]);
        }
      }
    }
    return largest;
  }

  // Whether a joint has far more there than ever otherwise: what a model lacks comes in bursts as
  // well, of all sizes.
  [[nodiscard]] bool is_largest(const LoudStretch& one, const VectorXd& otherwise) const {
    constexpr double kTimes = 20;  // in power
    for (Index joint = 0; joint < usual_.size(); ++joint) {
      if (!(usual_[joint] > 0)) continue;
      const VectorXd power = power_of(one.recording, joint);
      if (power.segment(one.samples.first, one.samples.count).maxCoeff() >
          kTimes * otherwise[joint])
        return true;
    }
    return false;
  }

  // From where it comes to half of its height to where it goes for longer than a moment: what a
  // low-pass makes of a step is there where the step is.
  [[nodiscard]] LoudStretch with_sharp_ends(const LoudStretch& rough) const {
    constexpr double kCore = 0.25;  // of the largest
    constexpr double kMomentS = 0.1;
    const Index window = 2 * half_window(rough.recording);
    const Index low = std::max<Index>(0, rough.samples.first - window);
    const Index high = std::min(layout_.samples(rough.recording), rough.end() + window);
    const SampleSpan around{low, high - low};
    const VectorXd height = height_of(rough.recording, around);
    Index top = 0;
    const double most =
        height.segment(rough.samples.first - low, rough.samples.count).maxCoeff(&top);
    top += rough.samples.first - low;
    std::vector<double> core;
    std::copy_if(height.begin(), height.end(), std::back_inserter(core),
                 [&](double value) { return value > kCore * most; });
    if (core.empty()) return rough;
    const auto middle = core.begin() + static_cast<std::ptrdiff_t>(core.size() / 2);
    std::nth_element(core.begin(), middle, core.end());
    const double half = *middle / 2;
    const Index moment =
        std::max<Index>(2, std::lround(kMomentS / layout_.period_s(rough.recording)));
    // The last one that is high, from the top on until it is low for a moment.
    const auto end_from_top = [&](Index step) {
      Index last = top;
      for (Index i = top; i >= 0 && i < around.count && std::abs(i - last) <= moment; i += step) {
        if (height[i] >= half) last = i;
      }
      return last;
    };
    const Index first = end_from_top(-1);
    const Index last = end_from_top(1);
    return {rough.recording, {low + first, last + 1 - first}};
  }

  // Whether it comes back with what a joint does: whether the mean error elsewhere at the same
  // position, velocity or load is most of what there is of it.
  [[nodiscard]] bool comes_back(const LoudStretch& one, const std::vector<Index>& joints) const {
    constexpr double kMost = 0.5;
    for (const char* variable : {"position", "velocity", "load"}) {
      double whole = 0;
      double rest = 0;
      for (const Index joint : joints) {
        const MatrixXd bins = bins_over(data_, joint, variable);
        VectorXd sum = VectorXd::Zero(bins.cols());
        VectorXd count = VectorXd::Zero(bins.cols());
        for (std::size_t r = 0; r < layout_.recording_count(); ++r) {
          const Index begin = layout_.begin(r, joint);
          for (Index row = begin; row < begin + layout_.samples(r); ++row) {
            const bool is_out = outside_[static_cast<std::size_t>(row)] == 0;
            if (is_out || !layout_.says_something(row)) continue;
            sum += left_[row] * bins.row(row).transpose();
            count += bins.row(row).transpose();
          }
        }
        const VectorXd mean = sum.cwiseQuotient(count.cwiseMax(1));
        for (Index i = one.samples.first; i < one.end(); ++i) {
          const Index row = layout_.begin(one.recording, joint) + i;
          whole += left_[row] * left_[row] / usual_[joint];
          rest += std::pow(left_[row] - bins.row(row).dot(mean), 2) / usual_[joint];
        }
      }
      if (rest < (1 - kMost) * whole) return true;
    }
    return false;
  }

  // Whether a fit that sees it too has most of it: where the arm is as it is nowhere else, what
  // links of which nothing is known say without it is a guess. Of a push half and more was left
  // where it was tried.
  [[nodiscard]] bool is_guessed(const LoudStretch& one, const LoudStretch& rough,
                                const std::vector<Index>& joints) const {
    constexpr double kMost = 0.7;
    std::vector<char> rows = outside_;
    mark(rough, 1, rows);
    const VectorXd seen = layout_.while_moving(regression_.fit(terms_, rows).residual);
    double without = 0;
    double with = 0;
    for (const Index joint : joints) {
      const Index from = layout_.begin(one.recording, joint) + one.samples.first;
      without += left_.segment(from, one.samples.count).squaredNorm() / usual_[joint];
      with += seen.segment(from, one.samples.count).squaredNorm() / usual_[joint];
    }
    return with < (1 - kMost) * without;
  }

  [[nodiscard]] double duration_s(const LoudStretch& one) const {
    return static_cast<double>(one.samples.count) * layout_.period_s(one.recording);
  }
  [[nodiscard]] bool is_short(const LoudStretch& one) const {
    constexpr double kShortestS = 0.15;
    return duration_s(one) < kShortestS;
  }
  [[nodiscard]] bool is_long(const LoudStretch& one) const {
    return duration_s(one) > kLongestPushS;
  }
  // Where a motion begins or ends, and filters see one side of it.
  [[nodiscard]] bool is_at_an_end(const LoudStretch& one) const {
    constexpr double kEdgeS = 0.5;
    const auto edge = static_cast<Index>(std::ceil(kEdgeS / layout_.period_s(one.recording)));
    return one.samples.first < edge || one.end() + edge > layout_.samples(one.recording);
  }

  // Nothing where it is none. `rough`: all that stands out with it.
  [[nodiscard]] std::optional<Push> push_in(const LoudStretch& one,
                                            const LoudStretch& rough) const {
    constexpr double kStandsOut = 5;  // sum of the logarithms
    constexpr double kOfTorque = 0.1;
    const Workspace& at = data_.recordings[one.recording];
    const VectorXd t_s = kept_samples(at.plan, at.motion.t_s);
    Push push{at.file, t_s[one.samples.first], t_s[one.end() - 1], {}, 0, 0};
    push.out_from_s = std::min(push.from_s, t_s[rough.samples.first]);
    push.out_to_s = std::max(push.to_s, t_s[rough.end() - 1]);
    std::vector<Index> joints;
    double stands_out = 0;
    double share = 0;
    for (Index joint = 0; joint < usual_.size(); ++joint) {
      const auto part =
          left_.segment(layout_.begin(one.recording, joint) + one.samples.first, one.samples.count);
      const double power = part.squaredNorm() / static_cast<double>(part.size());
      if (!(usual_[joint] > 0) || !(power > kShows * usual_[joint])) continue;
      stands_out += std::log(power / usual_[joint]);
      share = std::max(share, std::sqrt(power) / torque_[joint]);
      joints.push_back(joint);
      push.joints.push_back(
          {joint, std::sqrt(power), offnominal::unit_of(Quantity::kEffort, at.joint_type(joint))});
    }
    if (stands_out < kStandsOut || share < kOfTorque || comes_back(one, joints) ||
        is_guessed(one, rough, joints)) {
      return std::nullopt;
    }
    return push;
  }

  Data data_;
  const RowLayout& layout_;
  Regression regression_;
  std::vector<Term> terms_;
  const std::vector<Excitation>& excitation_;
  VectorXd torque_;    // rms per joint
  VectorXd residual_;  // of the last fit
  VectorXd left_;      // of it, where its joint moves
  VectorXd usual_;     // power of that, per joint
  VectorXd held_;      // torque that friction holds a joint at
  std::vector<VectorXd> standing_out_;
  std::vector<LoudStretch> loud_;
  std::vector<char> outside_;  // rows that are in none of these
};

}  // namespace

std::vector<Push> pushes_in(const Data& data, const RobotDescription& robot,
                            const std::vector<Excitation>& excitation) {
  return PushFinder(data, robot, excitation).run();
}

std::string words_of(const Push& push) {
  std::vector<Index> joints;
  const Push::OnJoint* most = nullptr;
  for (const Push::OnJoint& one : push.joints) {
    joints.push_back(one.joint);
    if (most == nullptr || one.rms_torque > most->rms_torque) most = &one;
  }
  std::string where;
  if (most != nullptr) {
    const std::string on =
        joints.size() == 1 ? "" : fmt::format("; most on joint {}", most->joint + 1);
    where =
        fmt::format("{}{}: {:.3g} {}", list_of_joints(joints), on, most->rms_torque, most->unit);
  }
  return fmt::format("{:.2f} to {:.2f} s of {} ({})", push.from_s, push.to_s, push.file, where);
}

void leave_out(const std::vector<Push>& pushes, std::vector<Log>& logs) {
  for (Log& log : logs) leave_out(pushes, log);
}

bool is_among(const Push& one, const std::vector<Push>& pushes) {
  return std::any_of(pushes.begin(), pushes.end(), [&](const Push& other) {
    return one.file == other.file && one.from_s <= other.to_s && one.to_s >= other.from_s;
  });
}

void leave_out(const std::vector<Push>& pushes, Log& log) {
  constexpr double kSpreadPeriods = 3;  // as of what the doctor leaves out
  for (const Push& push : pushes) {
    const bool overlaps =
        push.out_from_s <= log.t_s[log.t_s.size() - 1] && push.out_to_s >= log.t_s[0];
    if (push.file != log.file || !overlaps) continue;
    const auto row_at = [&](double t_s) {
      const auto at = std::lower_bound(log.t_s.begin(), log.t_s.end(), t_s);
      return std::min<Index>(at - log.t_s.begin(), log.sample_count() - 1);
    };
    const RowSpan rows{row_at(push.out_from_s), row_at(push.out_to_s)};
    for (Index joint = 0; joint < log.q.cols(); ++joint) {
      log.left_out.push_back({joint, rows, kSpreadPeriods});
    }
  }
}

}  // namespace offnominal::desk
