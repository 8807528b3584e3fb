// Plant, controller and monitor in one loop, tick by tick.
#pragma once

#include <cstdint>
#include <functional>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/monitor.hpp>
#include <type_traits>

#include "offnominal/sim/trajectory.hpp"
#include "offnominal/sim/two_link_plant.hpp"
#include "paper/run_observer.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::paper {

template <typename Scalar>
struct ControllerSetup {
  MonitorConfig<2, Scalar> monitor;  // max_compensation zero: the monitor watches and does not act
  ComputedTorqueGains<2, Scalar> gains;
};

struct LoopTiming {
  double period_s = 0.001;
  std::int64_t ticks = 0;
  int plant_substeps = 1;
};

/// What the arm shall do at a time of the run.
using DesiredAt = std::function<sim::DesiredMotion(double time_s)>;

/// Runs the loop from a start on the desired motion and shows every tick to `observe`. Throws
/// InputError when the monitor refuses its settings or a sample. Capacity is the number of hidden
/// units that are compiled in; instantiated for the capacities of with_capacity() and both scalars.
template <int Capacity, typename Scalar>
void run_closed_loop(const ControllerSetup<Scalar>& setup, const sim::TwoLinkPlant& plant,
                     const LoopTiming& timing, const DesiredAt& desired_at,
                     const TickObserver& observe);

inline constexpr int kPaperHiddenUnits = 35;  // section 5

/// Calls `use` with the smallest capacity that holds `hidden_units`, which must be at most
/// kMaxHiddenUnits, as a std::integral_constant.
template <typename Use>
void with_capacity(int hidden_units, Use&& use) {
  if (hidden_units <= kPaperHiddenUnits) {
    return use(std::integral_constant<int, kPaperHiddenUnits>{});
  }
  return use(std::integral_constant<int, kMaxHiddenUnits>{});
}

}  // namespace offnominal::desk::paper
