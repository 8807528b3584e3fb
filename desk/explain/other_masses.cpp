#include "explain/other_masses.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "identify/inertial_regressor.hpp"
#include "identify/nuisance.hpp"
#include "signal/norm_about_mean.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// A link's mass, and its centre in the link's size, are believed to be right to a fifth, two
// standard deviations of it at most.
constexpr double kDeviation = 0.2;
constexpr double kMostDeviations = 2;
constexpr double kReachM = 0.5;  // of what is carried

constexpr Index kMassAndPlace = 4;  // of the ten numbers of a link

// All joints' rows, one joint under the other: per kg and per kg m of first moment of each link.
std::vector<MatrixXd> torques_of_masses(const RobotDescription& robot, const TorquePair& pair) {
  std::vector<MatrixXd> links;
  for (std::size_t link = 0; link < robot.joints.size(); ++link) {
    const auto columns = inertial_regressor(robot, link, {pair.t_s, pair.q, pair.dq, pair.ddq});
    MatrixXd& own = links.emplace_back(pair.q.size(), kMassAndPlace);
    for (Index i = 0; i < kMassAndPlace; ++i) {
      own.col(i) = columns[static_cast<std::size_t>(i)].reshaped();
    }
  }
  return links;
}

// The same per share of the mass, at its place, and per share of the size by which the centre is
// moved.
MatrixXd per_share(const RobotDescription& robot, std::size_t link, const MatrixXd& of_masses) {
  const Joint<double>& joint = robot.joints[link].joint;
  MatrixXd columns = of_masses;
  columns.col(0) *= joint.mass_kg;
  for (Index axis = 0; axis < 3; ++axis) {
    const double moment = joint.mass_kg * joint.centre_of_mass_m[static_cast<std::size_t>(axis)];
    columns.col(0) += moment * of_masses.col(1 + axis);
    columns.col(1 + axis) *= joint.mass_kg * size_of_link(robot, link);
  }
  return columns;
}

}  // namespace

std::vector<double> sizes_about_mean(const MatrixXd& torques) {
  std::vector<double> sizes;
  for (Index joint = 0; joint < torques.cols(); ++joint) {
    sizes.push_back(norm_about_mean(torques.col(joint)));
  }
  return sizes;
}

OtherMasses::OtherMasses(const RobotDescription& robot, const TorquePair& pair,
                         std::vector<double> sizes, double noise)
    : pair_(pair), sizes_(std::move(sizes)) {
  constexpr double kSamples = 50;  // independent ones of a joint
  constexpr double kLeastNoise = 0.02;
  weight_ = std::sqrt(kSamples) / std::max(noise, kLeastNoise);
  const std::vector<MatrixXd> of_masses = torques_of_masses(robot, pair);
  MatrixXd links(pair.q.size(), 0);
  for (std::size_t link = 0; link < of_masses.size(); ++link) {
    const Index before = links.cols();
    links.conservativeResize(Eigen::NoChange, before + kMassAndPlace);
    links.rightCols(kMassAndPlace) = in_shares(per_share(robot, link, of_masses[link]));
  }
  const MatrixXd carried = in_shares(of_masses.back());
  const MatrixXd none(links.rows(), 0);
  fits_.push_back(fit_of(none, links));
  fits_.push_back(fit_of(carried, none));
  fits_.push_back(fit_of(carried, links));
}

VectorXd OtherMasses::left_of_each(const MatrixXd& error) const {
  const VectorXd all = in_shares(error.reshaped());
  VectorXd least = all;
  for (const Fit& fit : fits_) {
    const std::optional<VectorXd> left = left_of(fit, all);
    if (left && left->norm() < least.norm()) least = *left;
  }
  return norms(least);
}

OtherMasses::Fit OtherMasses::fit_of(const MatrixXd& carried, const MatrixXd& links) const {
  Fit fit{MatrixXd(links.rows(), carried.cols() + links.cols()), carried.cols(), {}, {}};
  fit.columns << carried, links;
  MatrixXd weighted = MatrixXd::Zero(links.rows() + links.cols(), fit.columns.cols());
  weighted.topRows(links.rows()) = weight_ * fit.columns;
  weighted.bottomRightCorner(links.cols(), links.cols()).diagonal().setConstant(1 / kDeviation);
  fit.solver.compute(weighted);
  if (fit.carried > 0) fit.of_given_mass.compute(weighted.rightCols(weighted.cols() - 1));
  return fit;
}

// The unknowns: where the mass that would be carried has its moments out of reach, the smallest one
// that has not. What a turned axis feels of a mass its rotor takes.
VectorXd OtherMasses::solved(const Fit& fit, const VectorXd& error) const {
  VectorXd sought = VectorXd::Zero(error.size() + fit.columns.cols() - fit.carried);
  sought.head(error.size()) = weight_ * error;
  VectorXd found = fit.solver.solve(sought);
  if (fit.carried == 0) return found;
  const double least = found.segment(1, fit.carried - 1).norm() / kReachM;
  if (found[0] >= least) return found;
  found[0] = least;
  sought.head(error.size()) -= weight_ * least * fit.columns.col(0);
  found.tail(found.size() - 1) = fit.of_given_mass.solve(sought);
  return found;
}

std::optional<VectorXd> OtherMasses::left_of(const Fit& fit, const VectorXd& error) const {
  constexpr double kHardly = 1.1;
  const VectorXd found = solved(fit, error);
  const Index links = found.size() - fit.carried;
  if ((found.tail(links).array().abs() > kMostDeviations * kDeviation).any()) return std::nullopt;
  if (fit.carried > 0 && found.segment(1, fit.carried - 1).norm() > kHardly * kReachM * found[0]) {
    return std::nullopt;
  }
  return error - fit.columns * found;
}

MatrixXd OtherMasses::in_shares(const MatrixXd& torques) const {
  MatrixXd shares = MatrixXd::Zero(torques.rows(), torques.cols());
  const Index rows = pair_.q.rows();
  for (Index joint = 0; joint < pair_.q.cols(); ++joint) {
    const double size = sizes_[static_cast<std::size_t>(joint)];
    if (!(size > 0)) continue;
    shares.middleRows(joint * rows, rows) =
        beside_drive(pair_, joint, torques.middleRows(joint * rows, rows)) / size;
  }
  return shares;
}

VectorXd OtherMasses::norms(const VectorXd& all) const {
  return all.reshaped(pair_.q.rows(), pair_.q.cols()).colwise().norm().transpose();
}

}  // namespace offnominal::desk
