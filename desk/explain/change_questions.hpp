#pragma once

#include <Eigen/Core>
#include <vector>

#include "explain/moments.hpp"
#include "identify/evidence.hpp"

namespace offnominal::desk {

// What a change has to be asked beside its likelihood: whether it is one at all.

// A remainder beside more columns, stacked and not weighted; what they do not add is left out.
Remainder beside_columns(Remainder at, const Eigen::MatrixXd& columns);

// Gain in log-likelihood that columns bring; 0 where they add nothing.
double likelihood_of(const Judge& judge, const Eigen::MatrixXd& columns);

// Whether no drift of an effect, a cubic in time or one that fades, brings nearly `likely`, which
// is what a step of it brings. `columns`: of the effect all the time, in that one of the
// recordings.
bool is_sudden(const Moments& moments, std::size_t recorded, const Eigen::MatrixXd& columns,
               double likely, const Judge& judge);

// The joints on which columns, stacked and not weighted, have a fifth of the energy that they have
// on the one where they have most.
std::vector<Eigen::Index> acting_joints(const Data& data, const Eigen::MatrixXd& columns,
                                        const Eigen::VectorXd& joint_weights);

// Whether free functions of position, velocity and load of the joints that it acts on take less
// than two thirds of what a change takes, or clearly less by themselves than it does: behind its
// moment they do not only move otherwise.
bool is_no_other_motion(const Data& data, const Remainder& remainder,
                        const Eigen::MatrixXd& columns);

}  // namespace offnominal::desk
