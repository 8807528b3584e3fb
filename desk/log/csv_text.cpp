#include "log/csv_text.hpp"

#include <string_view>

#include "common/number.hpp"

namespace offnominal::desk {
namespace {

void append_names(std::string& text, std::string_view quantity, Eigen::Index joints) {
  for (Eigen::Index joint = 0; joint < joints; ++joint) {
    text.append(1, ',').append(quantity).append(std::to_string(joint + 1));
  }
}

void append_row(std::string& text, const Eigen::MatrixXd& columns, Eigen::Index row) {
  for (Eigen::Index joint = 0; joint < columns.cols(); ++joint) {
    text.append(1, ',').append(shortest(columns(row, joint)));
  }
}

}  // namespace

std::string csv_text(const Log& log) {
  std::string text = "t";
  append_names(text, "q", log.joint_count());
  append_names(text, "dq", log.joint_count());
  append_names(text, "tau", log.joint_count());
  for (const auto& [name, values] : log.extra) text += "," + name;
  text += '\n';
  for (Eigen::Index i = 0; i < log.sample_count(); ++i) {
    text += shortest(log.t_s[i]);
    append_row(text, log.q, i);
    append_row(text, log.dq, i);
    append_row(text, log.tau, i);
    for (const auto& [name, values] : log.extra) text.append(1, ',').append(shortest(values[i]));
    text += '\n';
  }
  return text;
}

}  // namespace offnominal::desk
