#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "log/log.hpp"

namespace offnominal::desk::live {

/// What everything that is judged by itself is judged by, one number each; NaN where there is none.
struct Levels {
  std::span<const double> residual;
  std::span<const double> threshold;
  std::span<const double> act;  // the second level
};

/// The samples of the last seconds, in room that is taken once: t, q, dq, tau of every joint, then
/// the levels.
class History {
 public:
  /// `judged`: how many residuals there are.
  History(std::size_t joints, std::size_t judged, std::size_t rows);

  /// One number per joint, or per residual. The oldest row makes way.
  void push(double t_s, std::span<const double> q, std::span<const double> dq,
            std::span<const double> tau, const Levels& levels);
  void clear() { count_ = 0; }

  [[nodiscard]] std::size_t size() const { return count_; }
  /// From the oldest, 0.
  [[nodiscard]] double time_s(std::size_t row) const { return at(row)[0]; }
  /// Rows with from_s <= t <= to_s.
  struct Rows {
    std::size_t joints = 0;
    std::size_t judged = 0;
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> all;

    [[nodiscard]] Eigen::VectorXd time_s() const { return all.col(0); }
    [[nodiscard]] Eigen::VectorXd residual(std::size_t of) const;
    [[nodiscard]] Eigen::VectorXd threshold(std::size_t of) const;
    [[nodiscard]] Eigen::VectorXd act(std::size_t of) const;
    /// Those from that time on, and those before it.
    [[nodiscard]] Rows since(double from_s) const;
    [[nodiscard]] Rows before(double end_s) const;
    /// In the common format of recordings.
    [[nodiscard]] Log log(const std::string& file, double period_s) const;
  };
  [[nodiscard]] Rows between(double from_s, double to_s) const;

 private:
  [[nodiscard]] const double* at(std::size_t row) const {
    return rows_.data() + stride_ * ((first_ + row) % most_);
  }

  std::size_t joints_;
  std::size_t judged_;
  std::size_t stride_;
  std::size_t most_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::vector<double> rows_;
};

/// The same for the eye: of every kStepS the lowest and the highest residual, the lowest threshold
/// and the lowest second level, numbered from 0 on, the last kSteps of them.
class Strip {
 public:
  static constexpr double kStepS = 0.02;
  static constexpr std::size_t kSteps = 3000;  // a minute

  explicit Strip(std::size_t judged)
      : judged_(judged), stride_(1 + kOfEach * judged), numbers_(kSteps * stride_) {}

  void push(double t_s, const Levels& levels);

  /// Those that no sample will change any more, from number `from` on, as far as they are kept.
  struct Steps {
    std::uint64_t first = 0;                                     // number of the first
    std::uint64_t next = 0;                                      // to ask from next time
    std::vector<double> t_s;                                     // their beginnings
    std::vector<std::vector<double>> low, high, threshold, act;  // per residual
  };
  [[nodiscard]] Steps since(std::uint64_t from) const;

 private:
  static constexpr std::size_t kOfEach = 4;  // low, high, threshold, act

  [[nodiscard]] std::span<double> step(std::uint64_t number) {
    return std::span(numbers_).subspan((number % kSteps) * stride_, stride_);
  }
  [[nodiscard]] std::span<const double> step(std::uint64_t number) const {
    return std::span(numbers_).subspan((number % kSteps) * stride_, stride_);
  }

  std::size_t judged_;
  std::size_t stride_;
  std::vector<double> numbers_;
  std::uint64_t count_ = 0;  // of steps, the one under way included
};

}  // namespace offnominal::desk::live
