#include "explain/moments.hpp"

#include <algorithm>
#include <utility>

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

std::vector<Moments::Recorded> recorded_in(const Data& data) {
  constexpr double kEdgeS = 1;
  constexpr double kEdgeShare = 0.05;
  constexpr int kSteps = 80;
  constexpr double kSmallestStepS = 0.2;
  std::vector<Moments::Recorded> all;
  for (const Workspace& at : data.recordings) {
    const VectorXd t_s = kept_samples(at.plan, at.motion.t_s);
    if (t_s.size() == 0) continue;
    auto same =
        std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.file == at.file; });
    if (same == all.end()) same = all.insert(all.end(), {at.file, t_s[0], t_s[0], {}, {}});
    same->samples.insert(same->samples.end(), t_s.begin(), t_s.end());
  }
  for (Moments::Recorded& one : all) {
    std::sort(one.samples.begin(), one.samples.end());
    one.from_s = one.samples.front();
    one.to_s = one.samples.back();
    const double duration = one.to_s - one.from_s;
    const double edge = std::max(kEdgeS, kEdgeShare * duration);
    const double step = std::max(kSmallestStepS, duration / kSteps);
    for (double t = one.from_s + edge; t <= one.to_s - edge; t += step) one.grid.push_back(t);
  }
  return all;
}

}  // namespace

double Moments::Recorded::period_s() const {
  return samples.size() < 2 ? 0 : (to_s - from_s) / static_cast<double>(samples.size() - 1);
}

Moments::Moments(const Data& data, std::optional<TimeSpan> given)
    : data_(data), given_(std::move(given)) {
  if (given_) {
    recorded_ = {{given_->files.front(), 0, 0, {}, {given_->from_s}}};
  } else {
    recorded_ = recorded_in(data);
  }
  for (std::size_t r = 0; r < recorded_.size(); ++r) {
    shares_.emplace_back();
    for (std::size_t m = 0; m < recorded_[r].grid.size(); ++m) {
      shares_.back().push_back(shares_of(span(r, m), data_.recordings));
    }
  }
}

TimeSpan Moments::span(std::size_t recorded, std::size_t moment) const {
  if (given_) return *given_;
  return {{recorded_[recorded].file}, recorded_[recorded].grid[moment]};
}

MatrixXd Moments::behind(const MatrixXd& columns, std::size_t recorded, std::size_t moment) const {
  return within(shares_[recorded][moment], data_.layout, columns);
}

MatrixXd Moments::inside(const MatrixXd& columns, const TimeSpan& span) const {
  return within(shares_of(span, data_.recordings), data_.layout, columns);
}

MatrixXd Moments::shaped(const MatrixXd& columns, std::size_t recorded,
                         const std::function<double(double)>& of_part) const {
  const Recorded& in = recorded_[recorded];
  std::vector<VectorXd> shares(data_.recordings.size());
  for (std::size_t r = 0; r < shares.size(); ++r) {
    const Workspace& at = data_.recordings[r];
    if (at.file != in.file) continue;
    const VectorXd t_s = kept_samples(at.plan, at.motion.t_s);
    shares[r].resize(t_s.size());
    for (Index i = 0; i < t_s.size(); ++i) {
      shares[r][i] = of_part((t_s[i] - in.from_s) / (in.to_s - in.from_s));
    }
  }
  return within(shares, data_.layout, columns);
}

}  // namespace offnominal::desk
