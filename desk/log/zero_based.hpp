#pragma once

#include "log/named_columns.hpp"

namespace offnominal::desk {

// The common header with joints that count from 0, q0 .. and tau0 .., by the names that the rest
// knows: q0 is q1 then, with a remark. Without a column of joint 0 nothing is done. Throws
// InputError where they are not one for each of the robot's joints, or where one quantity counts
// from 0 and another from 1: read by their names all would be off by a joint, and nobody would see
// it. Columns with other than `samples` values are none of a joint.
void count_joints_from_one(NamedColumns& columns, Eigen::Index samples, int joints);

}  // namespace offnominal::desk
