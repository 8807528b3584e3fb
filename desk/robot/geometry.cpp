#include "robot/geometry.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <offnominal/model/chain.hpp>

#include "common/number.hpp"

namespace offnominal::desk {
namespace {

constexpr double kTolerance = 1e-6;
constexpr double kLastBits = 100 * std::numeric_limits<double>::epsilon();

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

double distance_from_rotation(const Eigen::Matrix3d& matrix) {
  return (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
}

std::array<double, 9> rows_of(const Eigen::Matrix3d& matrix) {
  std::array<double, 9> rows{};
  Eigen::Map<RowMajor>(rows.data()) = matrix;
  return rows;
}

Eigen::Matrix3d tensor_of(const std::array<double, 6>& inertia_kg_m2) {
  const auto& [xx, yy, zz, xy, xz, yz] = inertia_kg_m2;
  Eigen::Matrix3d tensor;
  tensor << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return tensor;
}

}  // namespace

std::optional<std::array<double, 3>> unit_vector(const std::array<double, 3>& vector) {
  const double norm = std::hypot(vector[0], vector[1], vector[2]);
  if (!(std::fabs(norm - 1) <= kTolerance)) return std::nullopt;
  if (std::fabs(norm - 1) <= kLastBits) return vector;
  return std::array{vector[0] / norm, vector[1] / norm, vector[2] / norm};
}

std::array<double, 9> rotation_of_rpy(const std::array<double, 3>& rpy_rad) {
  const Eigen::Matrix3d rotation =
      (Eigen::AngleAxisd(rpy_rad[2], Eigen::Vector3d::UnitZ()) *
       Eigen::AngleAxisd(rpy_rad[1], Eigen::Vector3d::UnitY()).toRotationMatrix()) *
      Eigen::AngleAxisd(rpy_rad[0], Eigen::Vector3d::UnitX()).toRotationMatrix();
  return rows_of(rotation);
}

std::optional<std::array<double, 9>> nearest_rotation(const std::array<double, 9>& matrix) {
  const Eigen::Matrix3d given = Eigen::Map<const RowMajor>(matrix.data());
  const double distance = distance_from_rotation(given);
  if (!(distance <= kTolerance) || given.determinant() < 0) return std::nullopt;
  if (distance <= kLastBits) return matrix;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(given, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return rows_of(svd.matrixU() * svd.matrixV().transpose());
}

std::optional<double> broken_triangle(const std::array<double, 6>& inertia_kg_m2) {
  const Eigen::Vector3d moments = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(
                                      tensor_of(inertia_kg_m2), Eigen::EigenvaluesOnly)
                                      .eigenvalues();  // ascending
  const double lacks = moments[2] - moments[0] - moments[1];
  if (moments[0] < moments[2] * kTolerance || !(lacks > 0)) return std::nullopt;
  return lacks / moments[2];
}

std::optional<std::array<double, 6>> nearest_inertia(const std::array<double, 6>& inertia_kg_m2) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(tensor_of(inertia_kg_m2));
  const Eigen::Vector3d& moments = solver.eigenvalues();
  const double trace = moments.sum();
  if (!(trace > 0)) return std::nullopt;
  // A little more than none, so that the last bits do not break it again.
  const Eigen::Vector3d second = (trace / 2 - moments.array()).max(kTolerance * trace);
  const Eigen::Vector3d possible = second.sum() - second.array();
  const Eigen::Matrix3d& axes = solver.eigenvectors();
  const Eigen::Matrix3d tensor = axes * possible.asDiagonal() * axes.transpose();
  return std::array{tensor(0, 0), tensor(1, 1), tensor(2, 2),
                    tensor(0, 1), tensor(0, 2), tensor(1, 2)};
}

std::string inertia_fault(const std::array<double, 6>& inertia_kg_m2) {
  Joint<double> probe;
  probe.inertia_kg_m2 = inertia_kg_m2;
  if (validate(probe) == Status::kOk) return {};
  const Eigen::Vector3d moments = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(
                                      tensor_of(inertia_kg_m2), Eigen::EigenvaluesOnly)
                                      .eigenvalues();
  // Six digits are enough to see what is wrong.
  const auto rounded = [](double x) { return fmt::format("{:.6g}", x); };
  const std::string list =
      rounded(moments[0]) + ", " + rounded(moments[1]) + ", " + rounded(moments[2]);
  if (moments[0] < moments[2] * kTolerance) {
    return "a tensor that is not positive definite (principal moments " + list + ")";
  }
  return "a tensor that breaks the triangle inequality (principal moments " + list +
         "; the largest exceeds the sum of the others)";
}

}  // namespace offnominal::desk
