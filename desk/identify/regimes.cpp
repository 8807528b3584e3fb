#include "identify/regimes.hpp"

#include <algorithm>
#include <functional>

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int kRegimeBins = 8;

using ColumnsOf = std::function<const MatrixXd&(const Workspace& at)>;

// Bin, from 0, of every value among equally filled ones; the first where it does not count.
std::vector<int> binned(const VectorXd& values, const VectorXd& counts) {
  std::vector<Index> order;
  for (Index i = 0; i < values.size(); ++i) {
    if (counts[i] > 0) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return values[a] < values[b]; });
  std::vector<int> bin(static_cast<std::size_t>(values.size()), 0);
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    bin[static_cast<std::size_t>(order[rank])] =
        static_cast<int>(rank * static_cast<std::size_t>(kRegimeBins) / order.size());
  }
  return bin;
}

// A joint's kept samples of all recordings, one after the other.
VectorXd kept_column(const Data& data, const ColumnsOf& of, Index joint) {
  const RowLayout& layout = data.layout;
  VectorXd all(layout.rows() / layout.joint_count());
  Index at = 0;
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    const Workspace& recording = data.recordings[r];
    all.segment(at, layout.samples(r)) = kept_samples(recording.plan, of(recording).col(joint));
    at += layout.samples(r);
  }
  return all;
}

// In the same order: 1, or 0 where the joint stands still and says nothing.
VectorXd counting(const RowLayout& layout, Index joint) {
  const VectorXd moving = layout.while_moving(VectorXd::Ones(layout.rows()));
  VectorXd all(layout.rows() / layout.joint_count());
  Index at = 0;
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    all.segment(at, layout.samples(r)) = moving.segment(layout.begin(r, joint), layout.samples(r));
    at += layout.samples(r);
  }
  return all;
}

RowLayout::Blocks grouped(const Data& data, const ColumnsOf& by, const ColumnsOf* sign_of) {
  const RowLayout& layout = data.layout;
  const int per_joint = sign_of != nullptr ? 2 * kRegimeBins : kRegimeBins;
  RowLayout::Blocks groups;
  groups.of_row.resize(static_cast<std::size_t>(layout.rows()));
  groups.count = per_joint * static_cast<int>(layout.joint_count());
  for (Index joint = 0; joint < layout.joint_count(); ++joint) {
    const std::vector<int> bin = binned(kept_column(data, by, joint), counting(layout, joint));
    const VectorXd sign = sign_of != nullptr ? kept_column(data, *sign_of, joint) : VectorXd();
    Index at = 0;
    for (std::size_t r = 0; r < layout.recording_count(); ++r) {
      for (Index i = 0; i < layout.samples(r); ++i, ++at) {
        const int half = sign.size() > 0 && sign[at] < 0 ? kRegimeBins : 0;
        groups.of_row[static_cast<std::size_t>(layout.begin(r, joint) + i)] =
            static_cast<int>(joint) * per_joint + half + bin[static_cast<std::size_t>(at)];
      }
    }
  }
  return groups;
}

}  // namespace

std::vector<RowLayout::Blocks> regimes_of(const Data& data) {
  const ColumnsOf position = [](const Workspace& at) -> const MatrixXd& { return at.motion.q; };
  const ColumnsOf velocity = [](const Workspace& at) -> const MatrixXd& { return at.motion.dq; };
  const ColumnsOf turning = [](const Workspace& at) -> const MatrixXd& { return at.motion.ddq; };
  const ColumnsOf load = [](const Workspace& at) -> const MatrixXd& { return at.load_torque; };
  return {grouped(data, velocity, &turning), grouped(data, position, nullptr),
          grouped(data, load, nullptr)};
}

}  // namespace offnominal::desk
