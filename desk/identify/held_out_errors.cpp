#include "identify/held_out_errors.hpp"

#include <utility>
#include <vector>

#include "identify/holdout.hpp"
#include "identify/regression.hpp"

namespace offnominal::desk {

HeldOutErrors held_out_errors(const RobotDescription& file, const ImprovedRobot& improved,
                              const std::vector<Term>& written) {
  const Relinearised& last = improved.last;
  NuisanceOptions no_skew = last.nuisance;
  no_skew.skew_samples = 0;
  std::vector<Workspace> recordings = last.data->recordings;
  for (Workspace& at : recordings) at.set_model(file);
  const Data of_file(std::move(recordings), file, no_skew);
  const Data data(*last.data, improved.made_with, no_skew);
  const Regression regression(data);
  const HoldOut parts(regression, nullptr);
  return {of_file.layout.rms(of_file.torque), of_file.layout.rms(of_file.target),
          parts.rms(parts.cross_validated_with_shapes(written))};
}

}  // namespace offnominal::desk
