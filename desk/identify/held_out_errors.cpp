#include "identify/held_out_errors.hpp"

#include <vector>

#include "identify/holdout.hpp"
#include "identify/regression.hpp"

namespace offnominal::desk {

HeldOutErrors held_out_errors(const RobotDescription& file, const ImprovedRobot& improved,
                              const std::vector<Term>& written) {
  const Relinearised& last = improved.last;
  NuisanceOptions no_skew = last.nuisance;
  no_skew.skew_samples = 0;
  const Data data(*last.data, improved.made_with, no_skew);
  std::vector<Workspace> recordings = data.recordings;
  std::vector<const Eigen::MatrixXd*> model;
  for (Workspace& at : recordings) {
    at.set_model(file);
    model.push_back(&at.model_torque);
  }
  const Regression regression(data);
  const HoldOut parts(regression, nullptr);
  return {data.layout.rms(data.torque),
          data.layout.rms(data.torque - data.layout.stack_all(recordings, model)),
          parts.rms(parts.cross_validated_with_shapes(written))};
}

}  // namespace offnominal::desk
