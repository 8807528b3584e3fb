#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/nuisance.hpp"
#include "identify/regression.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// The width of the smoothed sign, rad/s or m/s, is one number per joint: of whatever follows that
// joint's velocity by its sign, its own friction or a coupling of another joint.

// Joint whose velocity an effect follows: its own, or the one that it names.
Eigen::Index followed_joint(const Effect<double>& effect);
Eigen::Index followed_joint(const Term& term);

// Place of the width among an effect's parameters; the size of the list where it has none.
std::size_t width_of(EffectKind kind);

void set_sign_width(RobotDescription& robot, Eigen::Index joint, double width);

// Of a term that follows the joint and whose width a search has looked for by itself: from now on
// it has this one, and is looked for no more.
void hold_sign_width(Term& term, Eigen::Index joint, double width);

// The width that a search has found for some term that follows the joint; 0 where none has.
double searched_sign_width(const std::vector<Term>& terms, Eigen::Index joint);

// The width that effects of the robot have which are not fitted, per joint; 0 where none has one.
Eigen::VectorXd settled_sign_widths(const RobotDescription& robot,
                                    const std::vector<std::size_t>& fitted_effects);

// Joints that some term, or some fitted effect of the robot, follows by a smoothed sign, and whose
// width is not `settled`.
std::vector<Eigen::Index> joints_with_free_width(const RobotDescription& robot,
                                                 const std::vector<std::size_t>& fitted_effects,
                                                 const std::vector<Term>& terms,
                                                 const Eigen::VectorXd& settled);

// The width of one joint at which a fitted model meets the recordings best, between a thousandth of
// the joint's top speed (narrower than that it would follow the velocity's noise) and three tenths
// of it (wider, the sign would be viscous friction in disguise): on the grid first, then between
// its points. What acts on the joints concerned alone is fitted anew for each width, the rest stays
// as it is. The present width is kept where it is as good to 1e-6 of the error's energy. `robot`:
// what `data` was made with.
double best_sign_width(const Data& data, const RobotDescription& robot,
                       const std::vector<Term>& terms, const ModelFit& fit, Eigen::Index joint);

// What a wider sign of the joint does to the model's torque, stacked, per width.
Eigen::VectorXd width_derivative(const Data& data, const RobotDescription& robot,
                                 const std::vector<Term>& terms, const ModelFit& fit,
                                 Eigen::Index joint);

}  // namespace offnominal::desk
