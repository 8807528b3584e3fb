#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "look/roles.hpp"

namespace offnominal::desk {

// What a file without a header is taken for, by its numbers: the first column is the time where it
// ascends as a clock does, and columns of which others are the derivative are positions. What is
// left is a torque for each of them only where it is as many, and nothing of what was taken over
// again. What two columns would do for is none of them: it is said, and left.
struct NamelessGuess {
  Roles roles;
  std::vector<std::string> left;   // columns that are nothing of it
  std::vector<std::string> notes;  // why
};

// `names` in the file's order. `joints`: of the robot, 0 where that is not known. `t_s`, where it
// has values, is the time, and none of the columns.
[[nodiscard]] NamelessGuess roles_of_nameless(const std::vector<std::string>& names,
                                              const std::map<std::string, Eigen::VectorXd>& values,
                                              int joints, double period_s,
                                              const Eigen::VectorXd& t_s = {});

// Whether numbers ascend as the stamps of samples do; a count of rows does not.
[[nodiscard]] bool is_clock(const Eigen::VectorXd& x);

}  // namespace offnominal::desk
