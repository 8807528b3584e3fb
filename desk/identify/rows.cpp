#include "identify/rows.hpp"

#include <algorithm>
#include <cmath>

#include "common/parallel.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Calls work(i) for `count` signals of a recording, each of which is filtered for it: side by side
// where that takes some milliseconds.
template <typename Work>
void for_filters(std::size_t count, const Workspace& at, const Work& work) {
  constexpr Index kWorthIt = 60'000;
  parallel_for(count, threads_for(static_cast<Index>(count) * at.sample_count(), kWorthIt), work);
}

}  // namespace

RowLayout::RowLayout(const std::vector<Workspace>& recordings) {
  joints_ = recordings.empty() ? 0 : recordings[0].joint_count();
  for (const Workspace& at : recordings) {
    const Index samples = kept_samples(at.plan, at.motion.t_s).size();
    first_.push_back(rows_);
    samples_.push_back(samples);
    period_s_.push_back(at.plan.period_s());
    rows_ += samples * joints_;
  }
  const bool some_rest = std::any_of(recordings.begin(), recordings.end(), [](const Workspace& at) {
    return at.moving.size() > 0 || at.usable.size() > 0;
  });
  if (!some_rest) return;
  moving_ = VectorXd::Ones(rows_);
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const Workspace& at = recordings[r];
    for (Index joint = 0; joint < joints_; ++joint) {
      auto rows = moving_.segment(begin(r, joint), samples_[r]);
      if (at.usable.size() > 0) rows = kept_samples(at.plan, at.usable.col(joint));
      if (at.moving.size() == 0) continue;
      const VectorXd kept = rows.cwiseProduct(kept_samples(at.plan, at.moving.col(joint)));
      // Where the filter keeps nothing of what moves, rest is all there is (as in standstill.cpp).
      if (kept.sum() > 0) rows = kept;
    }
  }
}

void RowLayout::leave_out(const std::vector<char>& rows) {
  if (moving_.size() == 0) moving_ = VectorXd::Ones(rows_);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i] == 0) moving_[static_cast<Index>(i)] = 0;
  }
}

VectorXd RowLayout::while_moving(const VectorXd& values) const {
  return moving_.size() == 0 ? values : values.cwiseProduct(moving_).eval();
}

double RowLayout::moving_count(std::size_t recording, Index joint) const {
  const Index n = samples_[recording];
  return moving_.size() == 0 ? static_cast<double>(n)
                             : moving_.segment(begin(recording, joint), n).sum();
}

RowLayout::Blocks RowLayout::blocks(double block_s, int at_least) const {
  Blocks blocks;
  blocks.of_row.resize(static_cast<std::size_t>(rows_));
  for (std::size_t r = 0; r < samples_.size(); ++r) {
    const Index wanted = std::lround(block_s / period_s_[r]);
    const Index length = std::max<Index>(1, std::min<Index>(wanted, samples_[r] / at_least));
    const auto count = static_cast<int>(std::max<Index>(1, samples_[r] / length));
    for (Index joint = 0; joint < joints_; ++joint) {
      for (Index i = 0; i < samples_[r]; ++i) {
        const int block = std::min(static_cast<int>(i / length), count - 1);
        blocks.of_row[static_cast<std::size_t>(begin(r, joint) + i)] = blocks.count + block;
      }
    }
    blocks.count += count;
  }
  leave_out_empty(blocks);
  return blocks;
}

// What says nothing is no independent observation.
void RowLayout::leave_out_empty(Blocks& blocks) const {
  if (moving_.size() == 0) return;
  std::vector<int> number(static_cast<std::size_t>(blocks.count), -1);
  for (Index row = 0; row < rows_; ++row) {
    if (moving_[row] > 0)
      number[static_cast<std::size_t>(blocks.of_row[static_cast<std::size_t>(row)])] = 0;
  }
  int count = 0;
  for (int& one : number) {
    if (one == 0) one = count++;
  }
  // Where no row says anything they are all of one, which says nothing.
  blocks.count = std::max(count, 1);
  for (int& block : blocks.of_row) block = std::max(0, number[static_cast<std::size_t>(block)]);
}

std::vector<int> RowLayout::groups_of_joints(const Blocks& groups) const {
  std::vector<int> counts;
  for (Index joint = 0; joint < joints_; ++joint) {
    std::vector<char> seen(static_cast<std::size_t>(groups.count), 0);
    for (std::size_t r = 0; r < samples_.size(); ++r) {
      for (Index row = begin(r, joint); row < begin(r, joint) + samples_[r]; ++row) {
        if (!says_something(row)) continue;
        seen[static_cast<std::size_t>(groups.of_row[static_cast<std::size_t>(row)])] = 1;
      }
    }
    counts.push_back(static_cast<int>(std::count(seen.begin(), seen.end(), 1)));
  }
  return counts;
}

VectorXd RowLayout::stack(const std::vector<Workspace>& recordings,
                          const std::vector<Regressor>& per_recording) const {
  VectorXd column = VectorXd::Zero(rows_);
  for (std::size_t r = 0; r < per_recording.size(); ++r) {
    for_filters(per_recording[r].size(), recordings[r], [&](std::size_t i) {
      const JointTorque& torque = per_recording[r][i];
      column.segment(begin(r, torque.joint), samples_[r]) =
          filtered(recordings[r].plan, torque.values);
    });
  }
  return column;
}

VectorXd RowLayout::stack_kept(const std::vector<Workspace>& recordings,
                               const std::vector<Regressor>& per_recording) const {
  VectorXd column = VectorXd::Zero(rows_);
  for (std::size_t r = 0; r < per_recording.size(); ++r) {
    for (const JointTorque& torque : per_recording[r]) {
      column.segment(begin(r, torque.joint), samples_[r]) =
          kept_samples(recordings[r].plan, torque.values);
    }
  }
  return column;
}

VectorXd RowLayout::stack_all(const std::vector<Workspace>& recordings,
                              const std::vector<const MatrixXd*>& per_recording) const {
  VectorXd column(rows_);
  for (std::size_t r = 0; r < per_recording.size(); ++r) {
    for_filters(static_cast<std::size_t>(joints_), recordings[r], [&](std::size_t i) {
      const auto joint = static_cast<Index>(i);
      column.segment(begin(r, joint), samples_[r]) =
          filtered(recordings[r].plan, per_recording[r]->col(joint));
    });
  }
  return column;
}

VectorXd RowLayout::weighted(const VectorXd& values, const VectorXd& joint_weights) const {
  VectorXd result = while_moving(values);
  for (std::size_t r = 0; r < samples_.size(); ++r) {
    for (Index joint = 0; joint < joints_; ++joint) {
      result.segment(begin(r, joint), samples_[r]) *= joint_weights[joint];
    }
  }
  return result;
}

VectorXd RowLayout::energy(const VectorXd& values) const {
  VectorXd energy = VectorXd::Zero(joints_);
  for (std::size_t r = 0; r < samples_.size(); ++r) {
    for (Index joint = 0; joint < joints_; ++joint) {
      const Index first = begin(r, joint);
      energy[joint] += moving_.size() == 0 ? values.segment(first, samples_[r]).squaredNorm()
                                           : values.segment(first, samples_[r])
                                                 .cwiseProduct(moving_.segment(first, samples_[r]))
                                                 .squaredNorm();
    }
  }
  return energy;
}

VectorXd RowLayout::rms(const VectorXd& values) const {
  VectorXd mean = energy(values);
  for (Index joint = 0; joint < joints_; ++joint) {
    double count = 0;
    for (std::size_t r = 0; r < samples_.size(); ++r) count += moving_count(r, joint);
    mean[joint] /= std::max(1.0, count);
  }
  return mean.cwiseSqrt();
}

MatrixXd stacked_columns(const RowLayout& layout, const std::vector<Workspace>& recordings,
                         const EffectCandidate& candidate, Index joint, const ShapePoint& shape) {
  std::vector<std::vector<Regressor>> per_recording;
  for (const Workspace& at : recordings) {
    per_recording.push_back(candidate.regressors(at, joint, shape));
  }
  const std::size_t count = per_recording[0].size();
  MatrixXd columns(layout.rows(), static_cast<Index>(count));
  for (std::size_t c = 0; c < count; ++c) {
    std::vector<Regressor> regressors;
    for (auto& one : per_recording) regressors.push_back(std::move(one[c]));
    columns.col(static_cast<Index>(c)) = layout.stack(recordings, regressors);
  }
  return columns;
}

}  // namespace offnominal::desk
