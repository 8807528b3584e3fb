#pragma once

#include <Eigen/Core>
#include <Eigen/QR>
#include <optional>
#include <vector>

#include "explain/doctor_checks.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// Per joint, of its torques about their mean.
std::vector<double> sizes_about_mean(const Eigen::MatrixXd& torques);

// What masses that no file knows of would make of torques: links that are off the file as far as a
// poor CAD is, and something carried on the last one. On a light wrist its weight may turn the
// torque round. Beside any friction, rotor and offset of each joint's drive.
class OtherMasses {
 public:
  // `pair`: few rows, thinned(), which have to outlive it. `sizes`: per joint the norm of its
  // torque over these rows, which all is a share of; 0: the joint tells nothing. `noise`: the share
  // that counts as such, so that smaller errors ask for no other links.
  OtherMasses(const RobotDescription& robot, const TorquePair& pair, std::vector<double> sizes,
              double noise);

  // Norm, in shares, of what the best such masses leave of errors of the model's torques, per
  // joint; rows: samples, columns: joints. No link's mass or centre may be off by more than 40 %,
  // and what is carried has a mass and is within reach: otherwise the errors stay as they are.
  [[nodiscard]] Eigen::VectorXd left_of_each(const Eigen::MatrixXd& error) const;

 private:
  // Least squares, what is carried being anything and a link as the file has it until the rows say
  // otherwise.
  struct Fit {
    Eigen::MatrixXd columns;  // of what is carried, if it is in the fit, then of the links
    Eigen::Index carried = 0;
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver;
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> of_given_mass;  // all but what is carried's mass
  };
  [[nodiscard]] Fit fit_of(const Eigen::MatrixXd& carried, const Eigen::MatrixXd& links) const;
  [[nodiscard]] Eigen::VectorXd solved(const Fit& fit, const Eigen::VectorXd& error) const;
  [[nodiscard]] std::optional<Eigen::VectorXd> left_of(const Fit& fit,
                                                       const Eigen::VectorXd& error) const;
  [[nodiscard]] Eigen::MatrixXd in_shares(const Eigen::MatrixXd& torques) const;
  [[nodiscard]] Eigen::VectorXd norms(const Eigen::VectorXd& all) const;

  const TorquePair& pair_;
  std::vector<double> sizes_;
  double weight_ = 1;
  std::vector<Fit> fits_;
};

}  // namespace offnominal::desk
