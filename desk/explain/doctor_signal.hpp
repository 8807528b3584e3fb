#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "common/parallel.hpp"
#include "explain/data_fault.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

// What the doctor's checks ask of one signal.

namespace offnominal::desk {

// What `work` says of every joint of a recording, in their order; of a long one several at once.
template <typename Work>
auto of_every_joint(const Log& log, const Work& work) {
  std::vector<decltype(work(Eigen::Index{}))> all(static_cast<std::size_t>(log.q.cols()));
  for_every_column(log.q,
                   [&](Eigen::Index joint) { all[static_cast<std::size_t>(joint)] = work(joint); });
  return all;
}

// Rows that repeat the row before them exactly.
struct Burst {
  Eigen::Index first = 0;   // row that holds the value first
  Eigen::Index length = 0;  // rows that repeat it

  [[nodiscard]] Eigen::Index end() const { return first + length; }  // the last of them
};
std::vector<Burst> repeats_of(const Eigen::VectorXd& x);

// Rows after which a value that is back was a spike's.
inline constexpr Eigen::Index kLongestSpike = 5;

// How many rows' time may have passed from each row to the next: 1, or more where one was stamped
// late. A computer that is kept busy may be so before or behind the measurement: the steps of time
// on either side count.
Eigen::VectorXd rows_passed(const Log& log);

// Whether a burst holds a gap, or begins or ends so near to one that the gap makes it look so.
bool is_next_to_gap(const Log& log, const Burst& burst);

// How many rows up to each repeat the one before them.
std::vector<Eigen::Index> repeats_before_of(const Eigen::VectorXd& x);

// Share of the rows around a burst that repeat the row before them, at most: two standard errors
// up.
double own_repeats(const std::vector<Eigen::Index>& repeats_before, const Burst& burst);

// What a signal is rounded to. Printed with so many digits it is another at every size; of numbers
// that are not rounded it is nothing that matters.
class Rounding {
 public:
  explicit Rounding(const Eigen::VectorXd& x);

  // Of values of that size; infinity where nothing changes.
  [[nodiscard]] double at(double value) const;

 private:
  double smallest_;
  int digits_ = 0;  // 0: another number of digits at every value
};

// Whether a position flickers between a few values that it is rounded to: the joint stands still,
// and nothing can be said of how it moves.
bool stands_still(const Eigen::VectorXd& q);

// Per joint, whether its drive holds it while another one moves: what play, noise and a controller
// make of a rest shows no sign of a torque, no unit and no encoder that sticks or jumps. `q`: one
// column per joint.
std::vector<char> held_joints(const Eigen::MatrixXd& q, const RobotDescription& robot);
// The same, but for those whose measured velocity says that they move.
std::vector<char> held_joints(const Log& log, const RobotDescription& robot);

// Whether noise larger than what the signal is rounded to surrounds a burst: then no value of it
// repeats for long. Neither an encoder's steps nor printed digits are noise, however they vary.
bool is_noisy_around(const Eigen::VectorXd& x, const Burst& burst);

// The largest change of the way over `width` rows from one width to the next, but for what `events`
// single events make of it.
double usual_change_of_pace(const Eigen::VectorXd& x, Eigen::Index width, int events);

// Puts the stretches into a fault, with rows and times, in order.
void set_spans(const Log& log, const std::vector<RowSpan>& spans, DataFault& fault);
// "rows 1201 to 1500, 2.4 to 3 s", of the longest, and how many more there are.
std::string words_of_spans(const DataFault& fault);
std::string words_of(const FaultSpan& span);

}  // namespace offnominal::desk
