#pragma once

#include <Eigen/Core>

#include "log/log.hpp"

// A hold map: positions that a drive was told to hold, one after the other, and the torque that
// each took. A row is a reading at rest; the rows' order is that in which the positions were
// approached, and the time between them means nothing.

namespace offnominal::desk {

/// Which way a joint came to where it stands, reading by reading: 1 or -1; 0 throughout where it
/// never moves. A reversal is where the joint goes back further than `threshold` > 0 from the
/// furthest point since the last one, and counts from that point on. `q` has one reading or more.
Eigen::VectorXd approach_direction(const Eigen::Ref<const Eigen::VectorXd>& q, double threshold);

/// Makes a hold map of a log that has q and tau: t_s counts the readings from 0, period_s is 1, dq
/// is 0, and every joint gets its direction of approach, with a threshold of a hundredth of the
/// range that the joint covers.
void make_hold_map(Log& log);

}  // namespace offnominal::desk
