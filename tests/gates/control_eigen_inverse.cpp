#include <Eigen/Dense>

using Matrix7 = Eigen::Matrix<double, 7, 7>;

// Control: fixed size, and Eigen 3.4 asks for the heap all the same.
void gate_control_eigen_inverse(const Matrix7& matrix, Matrix7& result) {
  result = matrix.llt().solve(Matrix7::Identity());
}
