#include "identify/held_out_errors.hpp"

#include "identify/data.hpp"
#include "identify/holdout.hpp"
#include "identify/regression.hpp"

namespace offnominal::desk {

HeldOutErrors held_out_errors(const RobotDescription& file, const ImprovedRobot& improved,
                              const std::vector<Term>& written) {
  const Relinearised& last = improved.last;
  NuisanceOptions no_skew = last.nuisance;
  no_skew.skew_samples = 0;
  const Data data(*last.data, improved.made_with, no_skew);
  const Regression regression(data);
  const HoldOut parts(regression, nullptr);
  return {data.layout.rms(data.torque), errors_as_it_is(file, data),
          parts.rms(parts.cross_validated_with_shapes(written))};
}

}  // namespace offnominal::desk
