#include "explain/rereading.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "compare/inverse_model.hpp"
#include "explain/other_masses.hpp"
#include "robot/payload.hpp"
#include "signal/norm_about_mean.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Rereading::Rereading(const Log& log, const RobotDescription& robot, const TorquePair& pair)
    : rigid_(robot), rows_(thinned(pair)) {
  std::erase_if(rigid_.effects, [](const RobotEffect& effect) {
    return info_of(effect.kind)->action != EffectAction::kPointMass;
  });
  rigid_ = carrying(rigid_, log.payload);
  of_effects_ = rows_.model - model_torque(rigid_, {rows_.t_s, rows_.q, rows_.dq, rows_.ddq});
  constexpr double kMoves = 1e-3;  // rad or m, rms
  for (Index joint = 0; joint < rows_.q.cols(); ++joint) {
    const double root = std::sqrt(static_cast<double>(rows_.q.rows()));
    const bool tells = norm_about_mean(rows_.q.col(joint)) > kMoves * root;
    sizes_.push_back(tells ? norm_about_mean(rows_.measured.col(joint)) : 0);
  }
}

VectorXd Rereading::left_of_each(const Readings& readings) const {
  Motion motion{rows_.t_s, rows_.q, rows_.dq, rows_.ddq};
  for (Index joint = 0; joint < motion.q.cols(); ++joint) {
    const Reading& one = readings[static_cast<std::size_t>(joint)];
    if (one.position_turned) {
      for (MatrixXd* of : {&motion.q, &motion.dq, &motion.ddq}) of->col(joint) *= -1;
    }
    motion.q.col(joint).array() += one.zero;
  }
  const MatrixXd load = model_torque(rigid_, motion);
  VectorXd left = VectorXd::Zero(load.cols());
  for (Index joint = 0; joint < load.cols(); ++joint) {
    const auto at = static_cast<std::size_t>(joint);
    if (!(sizes_[at] > 0)) continue;
    const double sign = readings[at].torque_turned ? -1 : 1;
    // Its own friction turns with it.
    const double way = readings[at].position_turned ? -1 : 1;
    const VectorXd error =
        sign * rows_.measured.col(joint) - load.col(joint) - way * of_effects_.col(joint);
    left[joint] = beside_drive(rows_, joint, error).norm() / sizes_[at];
  }
  return left;
}

double Rereading::left_by(const Readings& readings) const {
  return rms_of_telling(left_of_each(readings));
}

double Rereading::left_by_masses(double noise) const {
  return rms_of_telling(
      OtherMasses(rigid_, rows_, sizes_, noise).left_of_each(rows_.measured - rows_.model));
}

double Rereading::rms_of_telling(const VectorXd& left_of_each) const {
  constexpr double kMost = 1.5;  // of one joint: it must not hide all others
  const auto telling =
      std::count_if(sizes_.begin(), sizes_.end(), [](double size) { return size > 0; });
  if (telling == 0) return 0;
  return left_of_each.cwiseMin(kMost).norm() / std::sqrt(static_cast<double>(telling));
}

}  // namespace offnominal::desk
