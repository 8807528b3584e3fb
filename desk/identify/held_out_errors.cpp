#include "identify/held_out_errors.hpp"

#include <utility>
#include <vector>

#include "identify/holdout.hpp"
#include "identify/regression.hpp"

namespace offnominal::desk {

HeldOutErrors held_out_errors(const RobotDescription& file, const Relinearised& last,
                              const std::vector<Term>& written) {
  NuisanceOptions none = last.nuisance;
  none.free_effects = std::vector<std::size_t>{};
  none.link_share = 0;
  none.sign_shapes = false;
  std::vector<Workspace> recordings = last.data->recordings;
  for (Workspace& at : recordings) at.set_model(file);
  const Data before(std::move(recordings), file, none);
  const Regression nothing(before);
  const HoldOut of_before(nothing, nullptr);
  const Regression regression(*last.data);
  const HoldOut of_after(regression, nullptr);
  return {before.layout.rms(before.torque), of_before.rms(of_before.residual({}, nothing.fit({}))),
          of_after.rms(of_after.cross_validated_with_shapes(written))};
}

}  // namespace offnominal::desk
