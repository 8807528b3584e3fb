#include "explain/free_function.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "explain/remainder.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// What a named effect has to take of what a free function takes.
constexpr double kTakes = 0.9;
// Where it is Coulomb or viscous friction, which every drive has: the rest of such a function is
// what its friction has beside them.
constexpr double kTakesOfDrive = 0.8;
// The same beside a free function of two variables, which is noisier and takes some of what has
// nothing to do with the effect.
constexpr double kTakesOfMap = 0.6;
// What is left is looked at where it stands so far above the noise ...
constexpr double kLeftAboveNoise = 1.5;
// ... and this share of it follows the variable on time that was not fitted.
constexpr double kLeftStructured = 0.15;

constexpr const char* kBoth = "position and velocity";

// The variable that an effect is a function of; empty where it is one of several or of none.
std::string variable_of(EffectKind kind) { return name_of(info_of(kind)->traits.follows); }

// Of what a free function of the variable takes.
double share_to_take(const std::string& variable, const std::vector<EffectAt>& effects) {
  if (variable != "velocity") return kTakes;
  const bool every_drive_has = std::all_of(effects.begin(), effects.end(), [](const EffectAt& one) {
    return one.kind == EffectKind::kCoulombFriction || one.kind == EffectKind::kViscousFriction;
  });
  return every_drive_has ? kTakesOfDrive : kTakes;
}

class Judgement {
 public:
  Judgement(const Regression& regression, FoundModel& found)
      : regression_(regression),
        data_(regression.data()),
        found_(found),
        left_(structure_of(data_, found.fit.residual)),
        at_first_(structure_of(data_, found.baseline.residual)),
        before_(data_.layout.rms(found.baseline.residual)),
        after_(data_.layout.rms(found.fit.residual)),
        floor_(noise_floor_of(data_, found.fit.residual)) {}

  struct Result {
    std::vector<OverVariable> shapes;
    std::vector<EffectAt> stand_ins;  // those of the shapes, and of what comes in time
  };

  Result judge() {
    Result result;
    std::vector<OverVariable>& shapes = result.shapes;
    for (Index joint = 0; joint < data_.layout.joint_count(); ++joint) {
      if (!(after_[joint] > kLeftAboveNoise * floor_[joint])) continue;
      const std::vector<EffectAt> all = effects_on(joint, "");
      if (all.empty()) continue;
      if (auto shape = of_all(joint, all)) {
        shapes.push_back(std::move(*shape));
        continue;
      }
      if (is_of_an_event(joint)) {
        result.stand_ins.insert(result.stand_ins.end(), all.begin(), all.end());
        continue;
      }
      for (const char* variable : {"position", "velocity", "load"}) {
        const std::vector<EffectAt> own = effects_on(joint, variable);
        if (own.empty()) continue;
        if (auto shape = of_variable(joint, variable, own)) shapes.push_back(std::move(*shape));
      }
    }
    for (const OverVariable& one : shapes) {
      result.stand_ins.insert(result.stand_ins.end(), one.stand_ins.begin(), one.stand_ins.end());
    }
    return result;
  }

 private:
  // Whether the larger part of a joint's error is still there, in a few stretches of time: a push
  // that effects were bent to.
  [[nodiscard]] bool is_of_an_event(Index joint) const {
    constexpr double kConcentratedInTime = 0.5;
    constexpr double kHalf = 0.5;
    return share_of(left_, joint, "time") >= kConcentratedInTime &&
           explained_share(before_[joint], after_[joint]) < kHalf;
  }

  // The accepted effects on a joint, of one variable or of any.
  [[nodiscard]] std::vector<EffectAt> effects_on(Index joint, const std::string& variable) const {
    std::vector<EffectAt> effects;
    for (const Accepted& one : found_.accepted) {
      const EffectKind kind = one.term.effect->kind();
      if (one.term.joint != joint) continue;
      if (variable.empty() || variable_of(kind) == variable) effects.push_back({kind, joint});
    }
    return effects;
  }

  // All of a joint's effects against a free function in their place.
  [[nodiscard]] std::optional<OverVariable> of_all(Index joint,
                                                   const std::vector<EffectAt>& all) const {
    const double taken = explained_share(before_[joint], after_[joint]);
    const auto shape = [&](const char* variable, double share) -> std::optional<OverVariable> {
      const std::vector<EffectAt> stand_ins = not_needed_beside(joint, variable, all);
      // Where every effect is needed beside it, the torque is one more that is missing.
      const VectorXd& residual =
          stand_ins.size() == all.size() ? found_.baseline.residual : found_.fit.residual;
      return shape_of(joint, variable, stand_ins, share, residual);
    };
    for (const char* variable : {"position", "velocity", "load"}) {
      const double free = share_of(at_first_, joint, variable);
      if (free < kLeftStructured || share_of(left_, joint, variable) < kLeftStructured) continue;
      if (taken < share_to_take(variable, all) * free) {
        return shape(variable, taken / free);
      }
    }
    const double free = share_of(at_first_, joint, kBoth);
    if (taken < kTakesOfMap * free && share_of(left_, joint, kBoth) > kLeftStructured) {
      // Of the two variables the one that tells more is drawn.
      const char* variable =
          share_of(at_first_, joint, "position") > share_of(at_first_, joint, "velocity")
              ? "position"
              : "velocity";
      return shape(variable, taken / free);
    }
    return std::nullopt;
  }

  // Which of a joint's effects take next to nothing where a free function of the variable is in the
  // model too: they were a part of it. What is needed all the same keeps its name.
  [[nodiscard]] std::vector<EffectAt> not_needed_beside(Index joint, const char* variable,
                                                        const std::vector<EffectAt>& all) const {
    const RowLayout& layout = data_.layout;
    const Remainder& at = found_.baseline.remainder;
    const auto of_joint = [&](const MatrixXd& columns) {
      Index rows = 0;
      for (std::size_t r = 0; r < layout.recording_count(); ++r) rows += layout.samples(r);
      MatrixXd own(rows, columns.cols());
      Index to = 0;
      for (std::size_t r = 0; r < layout.recording_count(); ++r) {
        own.middleRows(to, layout.samples(r)) =
            columns.middleRows(layout.begin(r, joint), layout.samples(r));
        to += layout.samples(r);
      }
      return own;
    };
    const auto beside = [&](const MatrixXd& columns) {
      MatrixXd weighted(at.residual.size(), columns.cols());
      for (Index c = 0; c < columns.cols(); ++c) weighted.col(c) = at.weighted(columns.col(c));
      return of_joint(at.beside_basis(std::move(weighted)));
    };
    const VectorXd target = of_joint(at.residual);
    const MatrixXd free = beside(bins_over(data_, joint, variable));
    std::vector<MatrixXd> effects;
    for (const Accepted& one : found_.accepted) {  // as `all` has them: there may be two of a kind
      if (one.term.joint == joint) effects.push_back(beside(columns_of(data_, one.term)));
    }
    const auto left = [&](std::size_t without) {
      Index width = free.cols();
      for (std::size_t i = 0; i < effects.size(); ++i) {
        if (i != without) width += effects[i].cols();
      }
      MatrixXd columns(free.rows(), width);
      columns.leftCols(free.cols()) = free;
      Index to = free.cols();
      for (std::size_t i = 0; i < effects.size(); ++i) {
        if (i == without) continue;
        columns.middleCols(to, effects[i].cols()) = effects[i];
        to += effects[i].cols();
      }
      const Eigen::ColPivHouseholderQR<MatrixXd> qr(columns);
      return (target - columns * qr.solve(target)).squaredNorm();
    };
    constexpr double kNeeded = 0.25;  // of what is left without it
    const double with_all = left(effects.size());
    std::vector<EffectAt> stand_ins;
    for (std::size_t i = 0; i < effects.size(); ++i) {
      if (!(with_all < (1 - kNeeded) * left(i))) stand_ins.push_back(all[i]);
    }
    return stand_ins;
  }

  // A joint's effects of one variable against a free function of it beside everything else.
  [[nodiscard]] std::optional<OverVariable> of_variable(Index joint, const char* variable,
                                                        const std::vector<EffectAt>& own) const {
    const double more = share_of(left_, joint, variable);
    if (more < kLeftStructured) return std::nullopt;
    std::vector<Term> others;
    for (const Accepted& one : found_.accepted) {
      if (!holds(own, {one.term.effect->kind(), one.term.joint})) others.push_back(one.term);
    }
    const ModelFit without = regression_.fit(others);
    const double energy = std::pow(data_.layout.rms(without.residual)[joint], 2);
    const double left = std::pow(after_[joint], 2);
    const double taken = std::max(0.0, energy - left);
    const double free = taken + left * more;
    if (taken >= share_to_take(variable, own) * free) return std::nullopt;
    return shape_of(joint, variable, own, taken / free, without.residual);
  }

  [[nodiscard]] OverVariable shape_of(Index joint, const char* variable,
                                      const std::vector<EffectAt>& stand_ins, double share,
                                      const VectorXd& residual) const {
    MapOver map = map_over(data_, residual, joint, variable);
    return {joint, variable, stand_ins, share, std::move(map.at), std::move(map.mean)};
  }

  const Regression& regression_;
  const Data& data_;
  FoundModel& found_;
  std::vector<StructureShare> left_, at_first_;
  VectorXd before_, after_, floor_;
};

}  // namespace

std::vector<OverVariable> leave_out_stand_ins(const Regression& regression, const HoldOut& hold_out,
                                              int threads, FoundModel& found) {
  if (found.accepted.empty() || regression.data().recordings[0].at_rest) return {};
  Judgement::Result result = Judgement(regression, found).judge();
  if (result.stand_ins.empty()) return std::move(result.shapes);
  std::erase_if(found.accepted, [&](const Accepted& one) {
    return holds(result.stand_ins, {one.term.effect->kind(), one.term.joint});
  });
  order_and_hold_out(regression, hold_out, threads, found);
  return std::move(result.shapes);
}

}  // namespace offnominal::desk
