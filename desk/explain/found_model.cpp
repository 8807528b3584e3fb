#include "explain/found_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "common/parallel.hpp"
#include "identify/evidence.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

Fall best_fall(const VectorXd& before, const VectorXd& after) {
  Fall best;
  for (Index joint = 0; joint < before.size(); ++joint) {
    if (!(before[joint] > 0)) continue;
    const double share = explained_share(before[joint], after[joint]);
    if (share > best.share) best = {joint, share, before[joint] * std::sqrt(std::max(0.0, share))};
  }
  return best;
}

bool is_worth_a_name(const Fall& fall, double torque) {
  constexpr double kLittle = 0.01;  // of the torque
  constexpr double kMost = 0.5;     // of the error's energy
  return fall.share >= kRelevantShare && (fall.share >= kMost || fall.rms >= kLittle * torque);
}

std::vector<Term> FoundModel::terms() const {
  std::vector<Term> terms;
  for (const Accepted& one : accepted) terms.push_back(one.term);
  return terms;
}

std::vector<Term> FoundModel::terms_without(std::size_t left_out) const {
  std::vector<Term> others = terms();
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(left_out));
  return others;
}

namespace {

// The first so many effects of every joint, as indices into all, in the order of the joints' own.
using OrderOfJoints = std::vector<std::vector<std::size_t>>;

std::vector<Term> first_of_joints(const std::vector<Accepted>& all, const OrderOfJoints& order,
                                  std::size_t depth) {
  std::vector<Term> terms;
  for (const auto& of_joint : order) {
    for (std::size_t i = 0; i < std::min(depth, of_joint.size()); ++i) {
      terms.push_back(all[of_joint[i]].term);
    }
  }
  return terms;
}

}  // namespace

void order_and_hold_out(const Regression& regression, const HoldOut& hold_out, int threads,
                        FoundModel& found) {
  const Data& data = regression.data();
  const auto joints = static_cast<std::size_t>(data.layout.joint_count());
  // Largest first on each joint: of what is left each time, the effect that takes most away. What
  // one joint has hardly touches another, so all joints go one step deeper at once.
  OrderOfJoints order(joints);
  std::vector<std::size_t> open(found.accepted.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  std::vector<VectorXd> errors{data.layout.rms(found.baseline.residual)};
  std::vector<VectorXd> held_out{hold_out.rms(found.held_out_before)};
  found.fit = found.baseline;
  found.held_out_after = found.held_out_before;
  for (std::size_t depth = 1; !open.empty(); ++depth) {
    std::vector<double> gains(open.size());
    const Judge judge(found.fit.remainder);
    parallel_for(open.size(), threads, [&](std::size_t i) {
      gains[i] = judge.gain(columns_of(data, found.accepted[open[i]].term));
    });
    for (std::size_t joint = 0; joint < joints; ++joint) {
      std::size_t best = open.size();
      for (std::size_t i = 0; i < open.size(); ++i) {
        if (static_cast<std::size_t>(found.accepted[open[i]].term.joint) != joint) continue;
        if (best == open.size() || gains[i] > gains[best]) best = i;
      }
      if (best == open.size()) continue;
      order[joint].push_back(open[best]);
      open.erase(open.begin() + static_cast<std::ptrdiff_t>(best));
      gains.erase(gains.begin() + static_cast<std::ptrdiff_t>(best));
    }
    const std::vector<Term> terms = first_of_joints(found.accepted, order, depth);
    found.fit = regression.fit(terms);
    found.held_out_after = hold_out.residual(terms, found.fit);
    errors.push_back(data.layout.rms(found.fit.residual));
    held_out.push_back(hold_out.rms(found.held_out_after));
  }
  // Over all joints: by the share of a joint's torque that goes.
  const VectorXd torque = data.layout.rms(data.torque);
  std::vector<std::size_t> taken(joints, 0);
  std::vector<Accepted> sorted;
  found.waterfall = {held_out[0]};
  while (sorted.size() < found.accepted.size()) {
    std::size_t best = joints;
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t joint = 0; joint < joints; ++joint) {
      if (taken[joint] == order[joint].size()) continue;
      const auto at = static_cast<Index>(joint);
      const double before = errors[taken[joint]][at];
      const double after = errors[taken[joint] + 1][at];
      const double share =
          (before * before - after * after) / std::max(torque[at] * torque[at], 1e-300);
      if (share <= most) continue;
      most = share;
      best = joint;
    }
    sorted.push_back(found.accepted[order[best][taken[best]++]]);
    VectorXd now = found.waterfall.back();
    const std::size_t deepest = *std::max_element(taken.begin(), taken.end());
    for (std::size_t joint = 0; joint < joints; ++joint) {
      const auto at = static_cast<Index>(joint);
      now[at] = held_out[order[joint].empty() ? deepest : taken[joint]][at];
    }
    found.waterfall.push_back(std::move(now));
  }
  found.accepted = std::move(sorted);
  found.fit = regression.fit(found.terms());
}

}  // namespace offnominal::desk
