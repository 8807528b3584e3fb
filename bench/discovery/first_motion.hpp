#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "offnominal/sim/hidden/case.hpp"

namespace offnominal::bench {

struct DesiredPositions {
  Eigen::VectorXd t_s;
  Eigen::MatrixXd q;  // n x 2, rad
};

// A motion that somebody made without thinking of identification, drawn from the seed. Of little
// excitation: one speed to and fro, a small range, one slow sinusoid, or one joint at rest under
// load while the other moves a little. Otherwise: about ten seconds of two sinusoids per joint,
// which excite and yet leave much open.
DesiredPositions poor_positions(const sim::hidden::Nominal& nominal, std::uint64_t seed,
                                int attempt);
DesiredPositions short_positions(const sim::hidden::Nominal& nominal, std::uint64_t seed,
                                 int attempt);

}  // namespace offnominal::bench
