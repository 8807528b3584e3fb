#pragma once

#include <Eigen/Core>
#include <vector>

#include "report/page.hpp"

namespace offnominal::desk {

// Amplitudes of the sines that a signal is made of: one of amplitude a makes a peak of height a
// (Hann windows, whose width blurs it over two steps of 1 / length).
struct Spectrum {
  std::vector<double> at;  // ascending, evenly stepped; empty: too short to say anything
  std::vector<double> amplitude;
};

// Over frequency, Hz, up to `most_hz`: the root mean square over pieces that overlap by half or
// more, as long as 1000 steps resolve. `t_s` ascends.
Spectrum spectrum_over_time(const Eigen::Ref<const Eigen::VectorXd>& t_s,
                            const Eigen::Ref<const Eigen::VectorXd>& values, double most_hz);

// Over the order: sines per turn of a joint, of the travel and not of the time, so that a ripple
// stands at its order however fast the joint moves. `turns`: its position, in turns, or in metres
// of one that slides. Up to the order of which the longest step between two samples is half a wave,
// and that `most_hz` lets through at a tenth of the greatest speed; 1000 steps at most. What is
// slower shows higher orders.
Spectrum spectrum_over_travel(const Eigen::Ref<const Eigen::VectorXd>& t_s,
                              const Eigen::Ref<const Eigen::VectorXd>& turns,
                              const Eigen::Ref<const Eigen::VectorXd>& values, double most_hz);

}  // namespace offnominal::desk
