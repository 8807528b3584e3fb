#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "log/csv_column.hpp"
#include "log/csv_layout.hpp"
#include "log/decimal_marks.hpp"

namespace offnominal::desk {

// a - b without overflow, and exact as long as it is small.
double difference(std::int64_t a, std::int64_t b);

// What makes a line of samples a plain one: the same for all lines of a file, but for what the
// lines before have shown.
struct PlainRows {
  const CsvLayout& layout;
  const DecimalMarks& marks;
  bool has_commas = false;  // as decimal marks
};

struct PlainRow {
  bool is_plain = false;
  double time = 0;  // of the column that ascends; 0 where there is none
};

// Writes the numbers of a line to row `row` of the columns that somebody needs, where all of its
// cells are plain numbers that tell nothing new. Else it is not plain, and the row may hold
// anything. `scratch`: anything. Several threads may do so at once, for other rows.
PlainRow read_plain_row(const PlainRows& rows, std::string_view line, Eigen::Index row,
                        std::vector<CsvColumn>& columns, std::string& scratch);

}  // namespace offnominal::desk
