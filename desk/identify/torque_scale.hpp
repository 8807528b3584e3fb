#pragma once

#include <cstddef>

#include "identify/regression.hpp"

namespace offnominal::desk {

// A torque constant that is off scales all that the drive is told, and so every coefficient that a
// regression finds beside it. What the numbers of a robot file are of a regression's:

// of the coefficients of term `i`;
double factor_of_term(const Data& data, const std::vector<Term>& terms, const ModelFit& fit,
                      std::size_t i);

// of the change of the file's number that is nuisance term `i`.
double factor_of_known(const Data& data, const std::vector<Term>& terms, const ModelFit& fit,
                       std::size_t i);

// 1 + the error of a joint's torque constant as the model of these recordings has it.
double scale_known(const Workspace& at, Eigen::Index joint);

}  // namespace offnominal::desk
