#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/effect_candidate.hpp"
#include "identify/workspace.hpp"

namespace offnominal::desk {

// How the filtered samples of every joint of every recording are stacked into one long vector, and
// which block of time each row belongs to. Blocks never span two recordings; the rows of one
// instant, joint by joint, are in one block.
class RowLayout {
 public:
  explicit RowLayout(const std::vector<Workspace>& recordings);

  [[nodiscard]] Eigen::Index rows() const { return rows_; }
  [[nodiscard]] Eigen::Index joint_count() const { return joints_; }
  [[nodiscard]] std::size_t recording_count() const { return samples_.size(); }
  [[nodiscard]] Eigen::Index samples(std::size_t recording) const { return samples_[recording]; }
  // First row of a joint in a recording; its samples follow.
  [[nodiscard]] Eigen::Index begin(std::size_t recording, Eigen::Index joint) const {
    return first_[recording] + joint * samples_[recording];
  }
  [[nodiscard]] double period_s(std::size_t recording) const { return period_s_[recording]; }
  // Block of every row, from 0, for blocks of about block_s seconds. One in which every joint
  // stands still does not count: its rows, whose weight is 0, are in the first. Of each recording
  // at_least so many, shorter ones where it has to be.
  struct Blocks {
    std::vector<int> of_row;
    int count = 0;
  };
  [[nodiscard]] Blocks blocks(double block_s, int at_least = 1) const;
  // Of how many of the groups each joint has rows that say something.
  [[nodiscard]] std::vector<int> groups_of_joints(const Blocks& groups) const;

  // A regressor's filtered samples, stacked; `per_recording` has one regressor per recording.
  [[nodiscard]] Eigen::VectorXd stack(const std::vector<Workspace>& recordings,
                                      const std::vector<Regressor>& per_recording) const;
  // The same samples without the filter, for screening.
  [[nodiscard]] Eigen::VectorXd stack_kept(const std::vector<Workspace>& recordings,
                                           const std::vector<Regressor>& per_recording) const;
  // A full-rate quantity per joint (rows: samples, columns: joints) of every recording, filtered.
  [[nodiscard]] Eigen::VectorXd stack_all(
      const std::vector<Workspace>& recordings,
      const std::vector<const Eigen::MatrixXd*>& per_recording) const;
  // Rows with a 0 here say nothing from now on, as those of a joint that stands still.
  void leave_out(const std::vector<char>& rows);
  // Whether a row says something: its joint moves there, and nothing left it out.
  [[nodiscard]] bool says_something(Eigen::Index row) const {
    return moving_.size() == 0 || moving_[row] > 0;
  }
  // Each row as it is, or 0 where its joint stands still (standstill.hpp) and says nothing.
  [[nodiscard]] Eigen::VectorXd while_moving(const Eigen::VectorXd& values) const;
  // How many samples of a joint in a recording are not left out so.
  [[nodiscard]] double moving_count(std::size_t recording, Eigen::Index joint) const;
  // Each row times its joint's weight; 0 where the joint stands still.
  [[nodiscard]] Eigen::VectorXd weighted(const Eigen::VectorXd& values,
                                         const Eigen::VectorXd& joint_weights) const;
  // Sum of squares per joint while it moves; rows beyond the layout's do not count.
  [[nodiscard]] Eigen::VectorXd energy(const Eigen::VectorXd& values) const;
  // Root mean square per joint while it moves.
  [[nodiscard]] Eigen::VectorXd rms(const Eigen::VectorXd& values) const;

 private:
  void leave_out_empty(Blocks& blocks) const;

  Eigen::Index rows_ = 0;
  Eigen::Index joints_ = 0;
  std::vector<Eigen::Index> samples_;
  std::vector<Eigen::Index> first_;
  std::vector<double> period_s_;
  Eigen::VectorXd moving_;  // per row 1 or 0; empty: 1 throughout
};

// Columns of a candidate at one shape: one per coefficient.
Eigen::MatrixXd stacked_columns(const RowLayout& layout, const std::vector<Workspace>& recordings,
                                const EffectCandidate& candidate, Eigen::Index joint,
                                const ShapePoint& shape);

}  // namespace offnominal::desk
