#include "identify/effects/effects.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;

// On the last link, at several places along the x axis of its frame: y and z are the defaults.
class TipPayload final : public EffectCandidate {
 public:
  TipPayload() : EffectCandidate(EffectKind::kTipPayload) {}
  std::vector<ShapeRange> shapes(const std::vector<Workspace>& at, Index joint) const override {
    const double centre =
        at[0].rigid.joints[static_cast<std::size_t>(joint)].joint.centre_of_mass_m[0];
    ShapeRange x = range_of(kX, at[0].joint_type(joint));
    x.grid = {1.5 * centre, 1.75 * centre, 2 * centre, 2.5 * centre, 3 * centre};
    return {x};
  }
  bool applies(const Workspace& at, Index joint) const override {
    return joint + 1 == at.joint_count();
  }
  bool acts_at_rest(const Workspace& at, Index joint) const override { return applies(at, joint); }

 protected:
  bool finds(const ParameterInfo& parameter) const override {
    return parameter.required || &parameter == &info().parameters[kX];
  }

 private:
  static constexpr std::size_t kX = 1;
};

}  // namespace

Candidate payload_candidate(EffectKind kind) {
  if (kind == EffectKind::kTipPayload) return std::make_unique<TipPayload>();
  return nullptr;
}

}  // namespace offnominal::desk
