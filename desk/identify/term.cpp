#include "identify/term.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd rows_in(const TimeSpan& span, const RowLayout& layout,
                 const std::vector<Workspace>& recordings) {
  VectorXd rows = VectorXd::Zero(layout.rows());
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const Workspace& at = recordings[r];
    if (at.file != span.file) continue;
    const VectorXd& t_s = at.motion.t_s;
    VectorXd inside(t_s.size());
    for (Index i = 0; i < t_s.size(); ++i) inside[i] = span.holds(t_s[i]) ? 1 : 0;
    const VectorXd kept = filtered(at.plan, inside);
    for (Index joint = 0; joint < layout.joint_count(); ++joint) {
      rows.segment(layout.begin(r, joint), layout.samples(r)) = kept;
    }
  }
  return rows;
}

}  // namespace offnominal::desk
