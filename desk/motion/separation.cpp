#include "motion/separation.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "explain/excitation.hpp"
#include "identify/data.hpp"
#include "identify/regression.hpp"

namespace offnominal::desk::motion {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr std::size_t kMostShapes = 5;
// One sine, one speed to and fro or a tiny range give at most 0.09, motions of several frequencies
// and speeds 0.13 and more: a rule of thumb for a motion of which there is no recording.
constexpr double kRichMotion = 0.11;

Log log_of(const FittedMotion& fitted, double rate_hz) {
  Log log;
  log.file = "designed motion";
  log.period_s = 1 / rate_hz;
  log.t_s = fitted.motion.t_s;
  log.q = fitted.motion.q;
  log.dq = fitted.motion.dq;
  log.tau = fitted.torque;
  log.dq_derived.assign(static_cast<std::size_t>(log.q.cols()), false);
  return log;
}

// `log_rate_hz`: of the recording to come, where it is sampled faster than `logs`.
Data data_of(RobotDescription robot, const std::vector<Log>& logs, const FilterPlan& plan,
             std::optional<double> log_rate_hz = std::nullopt) {
  const VectorXd widths = set_sign_widths(robot, logs, plan);
  auto recordings = make_workspaces(logs, robot, plan, widths);
  if (log_rate_hz) {
    for (Workspace& at : recordings) at.skew_s = 1 / *log_rate_hz;
  }
  return {std::move(recordings), robot, {}};
}

// Some points of a range, from end to end: evenly among the grid's, which for a spectrum are far
// too many and are spread by their logarithm.
std::vector<double> some_of(const ShapeRange& range, bool spectrum) {
  const std::size_t count = range.grid.size();
  if (count <= kMostShapes || range.kind == ShapeRange::Kind::kDiscrete) return range.grid;
  std::vector<double> points;
  for (std::size_t i = 0; i < kMostShapes; ++i) {
    const double part = static_cast<double>(i) / (kMostShapes - 1);
    if (spectrum) {
      points.push_back(range.grid[0] * std::pow(range.grid.back() / range.grid[0], part));
    } else {
      points.push_back(
          range
              .grid[static_cast<std::size_t>(std::llround(part * static_cast<double>(count - 1)))]);
    }
  }
  return points;
}

std::vector<ShapePoint> shapes_of(std::vector<ShapeRange> ranges, bool spectrum) {
  for (ShapeRange& range : ranges) range.grid = some_of(range, spectrum);
  return product_grid(ranges);
}

// Not the ends, which few robots have.
std::vector<std::size_t> inner(std::size_t count) {
  if (count <= 3) {
    std::vector<std::size_t> all(count);
    for (std::size_t i = 0; i < count; ++i) all[i] = i;
    return all;
  }
  return {count / 4, count / 2, (3 * count) / 4};
}

VectorXd rms_per_joint(const MatrixXd& torque) {
  return (torque.colwise().squaredNorm() / static_cast<double>(torque.rows())).cwiseSqrt();
}

// Directions that the adapting numbers explain, in units of the noise. One with a prior has a row
// more, which makes it as dear to move it as to leave its torque unexplained: of an effect that
// looks like it, it takes a half. That is an effect of about twice what the bounds allow; the
// motions of a smaller one cannot matter, since it is no finding.
MatrixXd adapting_basis(const Data& data, const VectorXd& weights) {
  const Index rows = data.layout.rows();
  const auto& terms = data.nuisance.terms;
  const auto count = static_cast<Index>(terms.size());
  MatrixXd columns(rows + count, count);
  Index kept = 0;
  for (Index i = 0; i < count; ++i) {
    const NuisanceTerm& term = terms[static_cast<std::size_t>(i)];
    if (term.kind == NuisanceTerm::Kind::kSignShape &&
        !data.recordings[0].knows_dry_friction(term.joint)) {
      continue;
    }
    VectorXd column = VectorXd::Zero(rows + count);
    column.head(rows) = data.layout.weighted(data.nuisance.columns.col(i), weights);
    const double torque = column.head(rows).norm();
    if (term.prior.is_informative()) column[rows + i] = torque;
    const double length = column.norm();
    if (!(length > 0) || !std::isfinite(length)) continue;
    columns.col(kept++) = column / length;
  }
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(columns.leftCols(kept));
  return qr.householderQ() * MatrixXd::Identity(rows + count, qr.rank());
}

// Columns of a contender in units of the noise.
MatrixXd weighted_columns(const Data& data, const VectorXd& weights, Index rows,
                          const Contender& one, const ShapePoint& shape) {
  const MatrixXd columns =
      stacked_columns(data.layout, data.recordings, *one.effect, one.joint, shape);
  MatrixXd weighted = MatrixXd::Zero(rows, columns.cols());
  for (Index c = 0; c < columns.cols(); ++c) {
    if (!columns.col(c).allFinite()) continue;
    weighted.col(c).head(columns.rows()) = data.layout.weighted(columns.col(c), weights);
  }
  return weighted;
}

MatrixXd orthonormal(const MatrixXd& columns) {
  constexpr double kNothing = 1e-9;
  MatrixXd scaled = columns;
  for (Index c = 0; c < scaled.cols(); ++c) {
    const double length = scaled.col(c).norm();
    if (length > kNothing) scaled.col(c) /= length;
  }
  Eigen::ColPivHouseholderQR<MatrixXd> qr(scaled);
  qr.setThreshold(1e-6);
  return qr.householderQ() * MatrixXd::Identity(columns.rows(), qr.rank());
}

// Of the squared difference between what the two models leave, block by block: its mean over the
// standard error of the mean. `part`: what the rival cannot explain, in units of the noise; twice
// its product with the noise is the difference's random part.
double evidence_of(const VectorXd& part, const RowLayout::Blocks& blocks) {
  VectorXd energy = VectorXd::Zero(blocks.count);
  for (std::size_t row = 0; row < blocks.of_row.size(); ++row) {
    const double value = part[static_cast<Index>(row)];
    energy[blocks.of_row[row]] += value * value;
  }
  const double mean = energy.mean();
  const double variance = (energy.array() - mean).square().mean() + 4 * mean;
  return variance > 0 ? mean / std::sqrt(variance / static_cast<double>(blocks.count)) : 0;
}

// The true effect at one shape.
struct Truth {
  VectorXd left;        // without what the adapting numbers explain
  double whole_length;  // with it
};

// The worst of a true effect's shapes against the rival's best; `rival` empty: against none.
Separation separate(const Data& data, const RowLayout::Blocks& blocks, const VectorXd& weights,
                    Index joint, const std::vector<Truth>& truths,
                    const std::vector<MatrixXd>& rival) {
  Separation worst;
  worst.noise_rms = 1 / weights[joint];
  worst.evidence = std::numeric_limits<double>::infinity();
  for (const Truth& truth : truths) {
    const double length = truth.left.norm();
    VectorXd part = truth.left;
    double least = length;
    for (const MatrixXd& shape : rival) {
      const VectorXd explained = shape.transpose() * truth.left;
      const double left = std::sqrt(std::max(0.0, length * length - explained.squaredNorm()));
      if (left >= least) continue;
      least = left;
      part = truth.left - shape * explained;
    }
    const double evidence = evidence_of(part, blocks);
    if (evidence >= worst.evidence) continue;
    worst.evidence = evidence;
    const double of = rival.empty() ? truth.whole_length : length;
    worst.sine = of > 0 ? std::min(1.0, least / of) : 0;
    worst.torque_rms = data.layout.rms(part.head(data.layout.rows()))[joint] / weights[joint];
  }
  if (truths.empty()) worst.evidence = 0;
  return worst;
}

SeparationTable table_of(const Data& data, const std::vector<Contender>& contenders,
                         const std::vector<MotionJudge::Role>& roles, std::size_t truth_count,
                         const VectorXd& weights) {
  const MatrixXd basis = adapting_basis(data, weights);
  const RowLayout::Blocks blocks = data.layout.blocks(kShortestBlockS);
  std::vector<std::vector<MatrixXd>> rivals(contenders.size());
  std::vector<std::vector<Truth>> truths(truth_count);
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    const MotionJudge::Role& role = roles[i];
    for (std::size_t s = 0; s < role.shapes.size(); ++s) {
      const MatrixXd whole =
          weighted_columns(data, weights, basis.rows(), contenders[i], role.shapes[s]);
      const MatrixXd left = whole - basis * (basis.transpose() * whole).eval();
      const bool true_too =
          std::find(role.as_truth.begin(), role.as_truth.end(), s) != role.as_truth.end();
      if (i < truth_count && true_too) {
        truths[i].push_back({left * role.sizes[s], (whole * role.sizes[s]).norm()});
      }
      MatrixXd directions = orthonormal(left);
      if (directions.cols() > 0) rivals[i].push_back(std::move(directions));
    }
  }
  SeparationTable table;
  for (const Excitation& one : excitation_of(data.recordings)) {
    table.excited.push_back(one.moves && one.separation >= kRichMotion);
  }
  table.of.resize(truth_count);
  for (std::size_t i = 0; i < truth_count; ++i) {
    for (std::size_t k = 0; k < contenders.size(); ++k) {
      table.of[i].push_back(separate(data, blocks, weights, contenders[i].joint, truths[i],
                                     i == k ? std::vector<MatrixXd>{} : rivals[k]));
    }
  }
  return table;
}

}  // namespace

MotionJudge::MotionJudge(const RobotDescription& robot, const FittedMotion& reference,
                         double design_rate_hz, std::vector<Contender> contenders,
                         std::size_t truths, const Expectation& expectation)
    : robot_(robot),
      rate_hz_(design_rate_hz),
      contenders_(std::move(contenders)),
      truths_(truths),
      expectation_(expectation),
      plan_(plan_filter({log_of(reference, design_rate_hz)}, robot)) {
  const VectorXd needed = rms_per_joint(reference.torque);
  // A joint that needs no torque on the reference motion still has noise.
  const VectorXd scale = needed.cwiseMax(1e-3 * needed.maxCoeff());
  noise_rms_ = expectation.noise_share * scale;
  const Data data = data_of(robot, {log_of(reference, rate_hz_)}, plan_, expectation.log_rate_hz);
  for (const Contender& one : contenders_) {
    Role role;
    role.shapes = shapes_of(one.effect->shapes(data.recordings, one.joint),
                            one.effect->spectrum() != EffectCandidate::Spectrum::kNone);
    role.as_truth = inner(role.shapes.size());
    for (const ShapePoint& shape : role.shapes) {
      const MatrixXd columns =
          stacked_columns(data.layout, data.recordings, *one.effect, one.joint, shape);
      VectorXd sizes = VectorXd::Zero(columns.cols());
      for (Index c = 0; c < columns.cols(); ++c) {
        const double rms = data.layout.rms(columns.col(c))[one.joint];
        if (!(rms > 0) || !std::isfinite(rms)) continue;
        sizes[c] = expectation.effect_share * scale[one.joint] / rms /
                   std::sqrt(static_cast<double>(columns.cols()));
      }
      role.sizes.push_back(std::move(sizes));
    }
    roles_.push_back(std::move(role));
  }
}

SeparationTable MotionJudge::judge(const FittedMotion& motion) const {
  return table_of(data_of(robot_, {log_of(motion, rate_hz_)}, plan_, expectation_.log_rate_hz),
                  contenders_, roles_, truths_, noise_rms_.cwiseInverse());
}

SeparationTable MotionJudge::judge(const std::vector<Log>& recordings) const {
  return table_of(data_of(robot_, recordings, plan_filter(recordings, robot_)), contenders_, roles_,
                  truths_, noise_rms_.cwiseInverse());
}

}  // namespace offnominal::desk::motion
