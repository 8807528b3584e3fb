#include "identify/inertial_columns.hpp"

#include <utility>

#include "identify/inertial_regressor.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;

std::shared_ptr<const MatrixXd> InertialColumns::of_link(const RowLayout& layout,
                                                         const std::vector<Workspace>& recordings,
                                                         Index link) {
  // 256 MB; what is beyond that is made anew each time.
  constexpr Index kMostNumbers = Index{32} << 20;
  const std::lock_guard lock(mutex_);
  if (const auto at = known_.find(link); at != known_.end()) return at->second;
  MatrixXd columns = MatrixXd::Zero(layout.rows(), kInertialNumbers);
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const Workspace& at = recordings[r];
    const std::vector<MatrixXd> torques =
        inertial_regressor(at.rigid, static_cast<std::size_t>(link), at.motion);
    for (Index number = 0; number < kInertialNumbers; ++number) {
      const MatrixXd& torque = torques[static_cast<std::size_t>(number)];
      for (Index joint = 0; joint <= link; ++joint) {
        columns.col(number).segment(layout.begin(r, joint), layout.samples(r)) =
            filtered(at.plan, torque.col(joint));
      }
    }
  }
  auto made = std::make_shared<const MatrixXd>(std::move(columns));
  if (numbers_ + made->size() <= kMostNumbers) {
    known_.emplace(link, made);
    numbers_ += made->size();
  }
  return made;
}

}  // namespace offnominal::desk
