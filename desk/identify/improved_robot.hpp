#pragma once

#include <string>
#include <vector>

#include "identify/estimates.hpp"
#include "identify/relinearise.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// A number of the file that fitted best where physics does not let it be: it was held at the end of
// what is possible.
struct HeldNumber {
  std::string what;  // which one, where, and what it asked for
  std::string why;   // what that usually means, or why it does not matter
  Eigen::Index joint = 0;
  // What it asked for beyond the end is more than nothing to the joint's torque, and the joint's
  // other numbers do not take most of it: the recordings contradict the end.
  bool contradicted = false;

  [[nodiscard]] std::string words() const { return what + ": " + why; }
};

// Whether a number of the joint was held at the end of what is possible against the recordings.
bool holds_what_cannot_be(const std::vector<HeldNumber>& held, Eigen::Index joint);

// Error of a joint's torque constant, as of torque_scale, that no search was about.
struct FittedConstant {
  Eigen::Index joint = 0;
  double error = 0;
};

// The robot as it was read, with what was found: the effects, marked fitted; the numbers of the
// effects that were fitted before; mass and inertia of the links. Fitted together, they belong
// together.
struct ImprovedRobot {
  RobotDescription robot;
  std::vector<std::size_t> added;  // per term: its effect in `robot`, or kUnwritten
  // The last fit, which all numbers are from: within what physics lets them be, without what no
  // robot file can say, and with widths of the sign that the file will have.
  Relinearised last;
  Relinearised found;          // the same terms beside what no robot file can say: for intervals
  RobotDescription made_with;  // what the data of `last` were made with
  std::vector<Eigen::Index> widths;  // joints whose width was fitted
  // Written too, all of them where one is worth it: what else is fitted belongs to them.
  std::vector<FittedConstant> constants;
  // Found, but not among the effects that a robot file can say; the rest is then of no use alone.
  std::vector<std::string> unwritable;
  std::vector<HeldNumber> held;
  std::vector<std::string> unphysical;  // why it must not be used; empty: it may
  std::vector<Eigen::Index> driven;  // joints whose friction gives energy, against the recordings
};

struct FileFitOptions {
  NuisanceOptions nuisance;  // that `data` was made with
  // Effects of the file that get new numbers, as indices; all others stay as they are.
  std::vector<std::size_t> refitted;
  // Width of the smoothed sign that is given, per joint; 0 or empty: none.
  Eigen::VectorXd given_widths;
  std::string source;        // what the effects say of where their numbers come from
  bool keeps_links = false;  // mass and inertia of the links stay as the file has them
};

// The effects of a robot that are marked fitted, as indices.
std::vector<std::size_t> fitted_effects(const RobotDescription& robot);

// `file`: the robot as it was read; `robot`: the one that `data` was made with; `found`: a model
// fitted to them. Links that differ from the file by less than kWorthWriting stay as they are.
ImprovedRobot improved_robot(const RobotDescription& file, const RobotDescription& robot,
                             const Data& data, const FileFitOptions& options, Relinearised found);

// Whether its links have other numbers than the file's.
bool moves_links(const ImprovedRobot& improved);

// Numbers of the last fit. An interval of a term is the wider one of the last fit's and of the
// model's that has the recordings' own beside it, a skew and other ways to build up at a reversal,
// and as much more as the two values are apart: what a file leaves out makes no number surer.
Estimates estimates_of(const ImprovedRobot& improved);

inline constexpr double kWorthWriting = 0.005;  // share of a link's mass, or of a torque constant
inline constexpr auto kUnwritten = static_cast<std::size_t>(-1);

}  // namespace offnominal::desk
