#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "identify/rows.hpp"

namespace offnominal::desk {

// Stacked columns of each link's ten numbers (inertial_regressor.hpp), of one set of recordings:
// the torque of any mass, place and inertia of a link is linear in them. They follow from the
// motion, the joints' places and gravity alone, so that whatever a model says of masses may share
// them. Any number of threads may ask at once.
class InertialColumns {
 public:
  [[nodiscard]] std::shared_ptr<const Eigen::MatrixXd> of_link(
      const RowLayout& layout, const std::vector<Workspace>& recordings, Eigen::Index link);

 private:
  std::mutex mutex_;
  std::map<Eigen::Index, std::shared_ptr<const Eigen::MatrixXd>> known_;
  Eigen::Index numbers_ = 0;  // in known_
};

}  // namespace offnominal::desk
