#include "identify/term.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::string words_of(const TimeSpan& span) {
  const std::string files = fmt::format("{}", fmt::join(span.files, " and "));
  if (!span.begins()) return "in " + files;
  return span.ends() ? fmt::format("from {:.4g} to {:.4g} s of {}", span.from_s, span.to_s, files)
                     : fmt::format("from {:.4g} s of {} on", span.from_s, files);
}

namespace {

bool leaves_a_mass(const Term& term, const VectorXd& coefficients,
                   const std::vector<Workspace>& recordings) {
  if (!term.effect->is_mass() || term.during || coefficients[0] >= 0) return true;
  const auto link = static_cast<std::size_t>(term.joint);
  return recordings[0].rigid.joints[link].joint.mass_kg + coefficients[0] > 0;
}

}  // namespace

bool can_be(const Term& term, const VectorXd& coefficients,
            const std::vector<Workspace>& recordings) {
  return term.effect->is_physical(coefficients) && leaves_a_mass(term, coefficients, recordings) &&
         term.effect->is_within_reach(recordings, term.joint, coefficients, term.shape,
                                      term.ranges);
}

std::vector<VectorXd> shares_of(const TimeSpan& span, const std::vector<Workspace>& recordings) {
  std::vector<VectorXd> shares(recordings.size());
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const Workspace& at = recordings[r];
    if (!span.is_of(at.file)) continue;
    const VectorXd& t_s = at.motion.t_s;
    VectorXd inside(t_s.size());
    for (Index i = 0; i < t_s.size(); ++i) inside[i] = span.holds(t_s[i]) ? 1 : 0;
    shares[r] = filtered(at.plan, inside);
  }
  return shares;
}

MatrixXd within(const std::vector<VectorXd>& shares, const RowLayout& layout,
                const MatrixXd& columns) {
  MatrixXd inside = MatrixXd::Zero(columns.rows(), columns.cols());
  for (std::size_t r = 0; r < shares.size(); ++r) {
    if (shares[r].size() == 0) continue;
    for (Index joint = 0; joint < layout.joint_count(); ++joint) {
      const Index begin = layout.begin(r, joint);
      inside.middleRows(begin, layout.samples(r)) =
          columns.middleRows(begin, layout.samples(r)).array().colwise() * shares[r].array();
    }
  }
  return inside;
}

}  // namespace offnominal::desk
