#pragma once

#include <vector>

#include "explain/found_model.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// What is believed of the links' numbers where nobody says it: right to a few per cent, as CAD is.
inline constexpr double kUsualLinkShare = 0.05;
// ... and of a torque constant beside links that are off further, as data sheets have them.
inline constexpr double kUsualConstantShare = 0.05;
// Beyond this a link's mass, centre of mass and inertia are off each by itself.
inline constexpr double kCadShare = 0.1;

// Links' numbers that may be off by so much. Beyond CAD's share each is off by itself, and then the
// torque constants may be off too: what is little known of a robot is not its links alone, and of
// constants that nobody doubts only the ratios would show.
NuisanceOptions with_link_share(NuisanceOptions options, double share);

// The same beside links of the next wider share that is tried; of those off by no more than CAD,
// what that may be off where each number is off by itself.
NuisanceOptions beside_wider_links(NuisanceOptions options);

// The same beside links of which nothing is known.
NuisanceOptions beside_unknown_links(NuisanceOptions options);

// What is carried is no error of the links: appends a payload anywhere on the last one to `terms`,
// its place fitted, where the search looks for it there (an arm of three joints or more whose file
// has none).
void add_payload(const Regression& regression, std::vector<Term>& terms);

// Wider shares, as far as the recordings ask for one: with mass, centre of mass and inertia of
// every link each free within it, Coulomb and viscous friction on every joint that moves, and a
// payload on the last link of an arm of three joints or more, held-out time has to become clearly
// more likely (at least one joint's error falls by a twentieth). The widest that does is the last
// of them, after all that are narrower: links that may be off by more than they are take the place
// of what is carried, and of springs. Empty where the usual one is as good. `robot` and `usual`:
// that `data` was made with.
std::vector<double> wider_link_shares(const RobotDescription& robot, const Data& data,
                                      const NuisanceOptions& usual, int threads);

// Of two searches, whether the one with the wider share is to be believed: it predicts held-out
// data clearly better than the one that had to explain the same by effects, or about as well where
// that one needed at least three effects more; a torque constant that the wide one fits is none of
// them. A link of another mass is an effect, and named: one mass that is wrong is believed rather
// than all links off a little, where a hundredth of a torque is at stake. `both_wide`: the narrower
// one has all links off already; where so little is at stake the errors of most joints have to
// fall, or a name has to give way, as wide links blur the numbers of what is found. A mass
// that vanishes into them at the price of another joint is no error of theirs.
bool is_clearly_better(const HoldOut& hold_out, const FoundModel& wide, const FoundModel& usual,
                       bool both_wide);

}  // namespace offnominal::desk
