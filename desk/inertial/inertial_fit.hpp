#pragma once

#include <memory>
#include <vector>

#include "identify/data.hpp"
#include "identify/on_progress.hpp"
#include "identify/regression.hpp"
#include "identify/stretches.hpp"
#include "inertial/base_parameters.hpp"
#include "inertial/consistent_fit.hpp"
#include "inertial/drive_model.hpp"
#include "inertial/identify.hpp"
#include "inertial/reduced_rows.hpp"

namespace offnominal::desk {

// Which drives get a rotor inertia: those that motions tell from the links, or all that could have
// one. What no motion tells apart is then shared as the links are believed.
enum class Rotors { kApartFromLinks, kAll };

// The fit behind identify(), on the engine's data: the regression that add and explain have, with
// ten numbers for every link beside it.
class InertialFit {
 public:
  // All of them have to outlive it.
  InertialFit(const RobotDescription& file, const IdentifyRequest& request,
              const std::vector<Log>& logs, const FilterPlan& plan, Rotors rotors,
              const OnProgress& on_progress);

  [[nodiscard]] const RobotDescription& file() const { return file_; }
  [[nodiscard]] const Data& data() const { return *data_; }
  [[nodiscard]] const std::vector<Term>& terms() const { return terms_; }
  // Nuisance and drives as the engine has them; columns() has them too, then ten of each link.
  [[nodiscard]] const Regression::Design& design() const { return design_; }
  [[nodiscard]] const Eigen::MatrixXd& columns() const { return columns_; }
  [[nodiscard]] const ConsistentModel& model() const { return model_; }
  [[nodiscard]] const ConsistentPoint& point() const { return point_; }
  [[nodiscard]] const DriveModel& drives() const { return drives_; }
  [[nodiscard]] const ReducedRows& reduced() const { return *reduced_; }
  [[nodiscard]] const Eigen::VectorXd& joint_weights() const { return weights_; }
  [[nodiscard]] double prior_weight() const { return prior_weight_; }
  [[nodiscard]] double share() const { return share_; }
  [[nodiscard]] const std::vector<Stretch>& stretches() const { return stretches_; }
  [[nodiscard]] const BaseRequest& base_request() const { return base_; }
  [[nodiscard]] bool moves(std::size_t joint) const { return base_.moves[joint] != 0; }
  // Joints that could have a rotor which no motion tells from the link, and the file has none of.
  [[nodiscard]] const std::vector<std::size_t>& untold_rotors() const { return untold_rotors_; }
  // Whether the file's own numbers of the link are believed.
  [[nodiscard]] bool is_known(std::size_t link) const;
  // Joints whose width of the sign was fitted, and what the data were made with.
  [[nodiscard]] const std::vector<Eigen::Index>& widths() const { return widths_; }
  [[nodiscard]] const RobotDescription& made_with() const { return robot_; }
  // Per joint: energy of the error on parts that are held out in turn, of the numbers that a file
  // can have; empty where there is one part only.
  [[nodiscard]] const Eigen::VectorXd& held_out_energy() const { return held_out_energy_; }
  // The fit as the engine has one.
  [[nodiscard]] ModelFit model_fit() const;
  // The file with what was found.
  [[nodiscard]] RobotDescription identified() const;

 private:
  void set_links();
  void find_standing();
  void scale_geometry();
  void choose_drives();
  [[nodiscard]] DriveRequest drive_request(std::vector<std::size_t> rotors, bool keep) const;
  void set_inertial_columns();
  void adopt_links();
  void set_width(Eigen::Index joint, double width);
  void build();
  void solve(double share, int passes);
  void fit_widths();
  void choose_share();
  [[nodiscard]] Eigen::VectorXd residual() const;
  [[nodiscard]] std::vector<double> shares() const;
  [[nodiscard]] Eigen::VectorXd without_skew(Eigen::VectorXd x) const;
  void put_links(RobotDescription& robot) const;
  void put_drives(RobotDescription& robot) const;

  const RobotDescription& file_;
  const IdentifyRequest& request_;
  const std::vector<Log>& logs_;
  const FilterPlan& plan_;
  RobotDescription robot_;  // that the data are made with
  std::vector<Stretch> stretches_;
  std::vector<Workspace> recordings_;
  NuisanceOptions nuisance_;
  Rotors rotors_;
  std::vector<std::size_t> untold_rotors_;
  BaseRequest base_;
  DriveModel drives_;
  Eigen::VectorXd settled_;
  std::vector<Eigen::Index> widths_;
  std::unique_ptr<Data> data_;
  std::unique_ptr<Regression> regression_;
  std::vector<Term> terms_;
  Regression::Design design_;
  std::vector<Eigen::Matrix4d> about_;  // upper factors of what is believed, per free link
  Eigen::MatrixXd of_links_;  // ten columns per free link, stacked: they depend on the motion alone
  Eigen::MatrixXd columns_;
  std::unique_ptr<ReducedRows> reduced_;
  ConsistentModel model_;
  ConsistentPoint point_;
  Eigen::VectorXd weights_;
  double prior_weight_ = 1;
  double share_ = 0;
  Eigen::VectorXd held_out_energy_;
};

// A number of a new drive effect that came out as nothing is not written.
[[nodiscard]] bool is_nothing(const Term& term, const Eigen::VectorXd& coefficients);

}  // namespace offnominal::desk
