#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robot/robot.hpp"

namespace offnominal::desk {

// Samples first to last, both included.
struct RowSpan {
  Eigen::Index first = 0;
  Eigen::Index last = 0;

  [[nodiscard]] Eigen::Index count() const { return last + 1 - first; }
};

// Samples of a joint that no analysis may use: a gap, or what the doctor found.
struct LeftOut {
  Eigen::Index joint = 0;
  RowSpan rows;
  // What a filter spreads of them on either side and goes with them, in periods of its cut-off.
  double spread_periods = 0;
};

// Rows as they were recorded, uneven in time: what a resampling makes of them has no encoder's
// step.
struct RecordedRows {
  Eigen::VectorXd t_s;
  Eigen::MatrixXd q, dq, tau;  // as of the log
  Eigen::Index first = 0;      // of them, among those of the file
};

// One recording in SI units, evenly sampled, time ascending, every number finite. Or a hold map
// (hold_map.hpp), where at_rest.
struct Log {
  std::string file;     // as the user named it
  double period_s = 0;  // sampling period
  Eigen::VectorXd t_s;  // as recorded, or the even grid it was resampled to
  Eigen::MatrixXd q;    // rows: samples, columns: joints; rad or m
  Eigen::MatrixXd dq;   // rad/s or m/s
  // Positions as the encoders say them at that time, where q is that of an earlier one
  // (observed_motion.hpp); else empty. As q.
  Eigen::MatrixXd readings;
  // Torque of the drive, at the joint; or what a sensor behind the gear says, where that is all
  // there is of a joint (of_sensor()). N m or N.
  Eigen::MatrixXd tau;
  // What such a sensor says beside tau: columns as tau, those of other joints 0; no rows where no
  // joint has both (has_both()).
  Eigen::MatrixXd sensor_tau;
  std::vector<bool> dq_derived;  // per joint: dq is the derivative of the low-passed q
  std::map<std::string, Eigen::VectorXd> extra;  // further quantities, by name
  bool at_rest = false;
  Eigen::MatrixXd approach;             // where at_rest: 1 or -1, as q; else empty
  std::vector<std::string> remarks;     // what a reader of results has to know, in words
  ChannelMap channels;                  // where the columns came from; empty: not read from a file
  bool common_header = false;           // by their names alone, nobody gave the channels
  std::optional<Payload> payload = {};  // that the robot carried (robot/payload.hpp)
  Eigen::VectorXd stamps_s;  // of the recorded rows, where t_s is another grid; else empty
  std::shared_ptr<const RecordedRows> recorded = {};  // where it was resampled; else null
  std::vector<RowSpan> gaps;  // samples of the grid where none were recorded
  // Of the rows that were read, where some of the file's had to be left out; else empty.
  std::vector<Eigen::Index> row_numbers = {};
  std::vector<RowSpan> cut;       // recorded rows beyond a gap that is too long for one grid
  std::vector<LeftOut> left_out;  // of `gaps` and of faults, in any order

  [[nodiscard]] bool of_sensor(std::size_t joint) const {
    return joint < channels.torque_of.size() && channels.torque_of[joint] == ChannelOf::kSensor;
  }
  [[nodiscard]] bool has_both(std::size_t joint) const {
    return joint < channels.sensor_torque.size() && channels.sensor_torque[joint].has_value();
  }
  [[nodiscard]] int joint_count() const { return static_cast<int>(q.cols()); }
  [[nodiscard]] Eigen::Index sample_count() const { return t_s.size(); }
  [[nodiscard]] double sample_rate_hz() const { return 1 / period_s; }
  // Of a row that was read its number in the file, both from 0.
  [[nodiscard]] Eigen::Index row_number(Eigen::Index row) const {
    return row_numbers.empty() ? row : row_numbers[static_cast<std::size_t>(row)];
  }
  // The rows of the file, from 0, that a span of samples comes from; of a gap those that were left
  // out, or the one behind it.
  [[nodiscard]] RowSpan recorded_rows(const RowSpan& samples) const {
    const RowSpan read = rows_read(samples);
    const RowSpan rows{row_number(read.first), row_number(read.last)};
    const bool is_gap = stamps_s.size() > 0 && read.first > 0 &&
                        stamps_s[read.first] > t_s[samples.last] + period_s / 2;
    const Eigen::Index before = is_gap ? row_number(read.first - 1) + 1 : rows.first;
    return is_gap && before < rows.first ? RowSpan{before, rows.first - 1} : rows;
  }
  [[nodiscard]] RowSpan rows_read(const RowSpan& samples) const {
    if (stamps_s.size() == 0) return samples;
    const double slack = period_s / 2;
    const auto row_at = [&](double t) {
      const auto at = std::lower_bound(stamps_s.begin(), stamps_s.end(), t);
      return std::min<Eigen::Index>(at - stamps_s.begin(), stamps_s.size() - 1);
    };
    const Eigen::Index first = row_at(t_s[samples.first] - slack);
    return {first, std::max(first, row_at(t_s[samples.last] + slack) - 1)};
  }
};

}  // namespace offnominal::desk
