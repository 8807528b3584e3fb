#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "identify/data.hpp"
#include "identify/term.hpp"

namespace offnominal::desk {

// Where in recordings something may change, and what columns are behind a moment.
class Moments {
 public:
  // The stretches of one recording; or, where the only change that is asked of is given, nothing
  // but that one moment.
  struct Recorded {
    std::string file;
    double from_s = 0;
    double to_s = 0;
    std::vector<double> samples;  // time stamps of the filtered samples, ascending
    // Moments to be tried, at least a second and a twentieth of it away from its ends; empty: it
    // is too short.
    std::vector<double> grid;

    [[nodiscard]] double step_s() const { return grid.size() < 2 ? 0 : grid[1] - grid[0]; }
    [[nodiscard]] double period_s() const;
    // Whether a moment is so far away from both ends.
    [[nodiscard]] bool is_inside(double t_s, double edge_s) const {
      return t_s - from_s >= edge_s && to_s - t_s >= edge_s;
    }
  };

  // `data` have to outlive it. `given`: the only part that may differ from the rest, recordings
  // made later or what is behind a moment.
  Moments(const Data& data, std::optional<TimeSpan> given);

  [[nodiscard]] bool are_given() const { return given_.has_value(); }

  [[nodiscard]] const std::vector<Recorded>& recorded() const { return recorded_; }
  // What is behind a moment of that recording's grid.
  [[nodiscard]] TimeSpan span(std::size_t recorded, std::size_t moment) const;
  // Stacked columns of what acts behind a moment of that recording's grid, or in a part of one.
  [[nodiscard]] Eigen::MatrixXd behind(const Eigen::MatrixXd& columns, std::size_t recorded,
                                       std::size_t moment) const;
  [[nodiscard]] Eigen::MatrixXd inside(const Eigen::MatrixXd& columns, const TimeSpan& span) const;
  // Stacked columns times a function of the part, 0 to 1, of that recording that has passed.
  [[nodiscard]] Eigen::MatrixXd shaped(const Eigen::MatrixXd& columns, std::size_t recorded,
                                       const std::function<double(double)>& of_part) const;

 private:
  const Data& data_;
  std::optional<TimeSpan> given_;
  std::vector<Recorded> recorded_;
  std::vector<std::vector<std::vector<Eigen::VectorXd>>> shares_;  // per recorded and moment
};

}  // namespace offnominal::desk
