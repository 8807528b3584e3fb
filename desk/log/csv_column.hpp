#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "log/named_columns.hpp"

namespace offnominal::desk {

// A column of a text file of samples, as it is read.
struct CsvColumn {
  // What the cells are; of a column of time alone more than plain numbers.
  enum class Form : std::uint8_t { kNumber, kLongNumber, kDate };

  std::string name;  // that it is asked for by
  Need need = Need::kNone;
  Form form = Form::kNumber;
  std::int64_t origin = 0;  // of what is no plain number
  // The cell with the date, where this one has the time of day, or the other way round.
  std::optional<std::size_t> other_half = std::nullopt;
  // Grows by doubling; what is not written to is not in memory.
  Eigen::VectorXd values;
};

}  // namespace offnominal::desk
