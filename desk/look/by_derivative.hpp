#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "look/roles.hpp"

namespace offnominal::desk {

// Sets right what names took for another quantity than the data show: positions that are the
// derivative of what is called a velocity change places with it, and of two families of positions
// the one that is the derivative of the other is its velocity, where no other velocity goes with
// it. Says each in words. `roles` are those of joints, `values` by name.
[[nodiscard]] std::vector<std::string> set_right_by_derivative(
    Roles& roles, const std::map<std::string, Eigen::VectorXd>& values, const Eigen::VectorXd& t_s);

}  // namespace offnominal::desk
