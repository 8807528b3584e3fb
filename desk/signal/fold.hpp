#pragma once

#include <Eigen/Core>
#include <vector>

namespace offnominal::desk {

// Where a column that is folded into `range`, as an angle into a turn, passes from one end to the
// other: the rows before it, in order. Each is a step by the range but for a few percent, or but
// for what the column does between two samples elsewhere. None where the column spans more than
// the range, or where other steps are so large that a fold cannot be told from them.
std::vector<Eigen::Index> folds_of(const Eigen::Ref<const Eigen::VectorXd>& x, double range);

// Positions that are folded into a range which is known without their encoder.
struct KnownFold {
  double range = 0;
  double low = 0;                   // where the range begins
  std::vector<Eigen::Index> folds;  // none: they are not
};

// A turn, 2 pi; or the 25 rad of motors that speak the MIT mini cheetah's protocol, 16 bit from
// -12.5 to 12.5, where they are filled. `x` in rad.
KnownFold known_fold_of(const Eigen::Ref<const Eigen::VectorXd>& x);

// The same of a column whose unit is not known: in rad, or folded into a turn of 360 degrees.
KnownFold known_fold_in_any_unit(const Eigen::Ref<const Eigen::VectorXd>& x);

// Takes a range off, or adds it, from each of these rows on.
void unfold(Eigen::Ref<Eigen::VectorXd> x, double range, const std::vector<Eigen::Index>& folds);

}  // namespace offnominal::desk
