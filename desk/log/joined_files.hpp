#pragma once

#include <vector>

#include "log/named_columns.hpp"
#include "log/time_of.hpp"

namespace offnominal::desk {

// One file of a recording that has several, its time taken from its columns.
struct TimedColumns {
  NamedColumns columns;
  FileTime time;
};

// In which unit a time is that was taken for one in s beside another: "ms", "us", "ns", by how many
// times it lasts as long, in steps as many times as long; null: s, as the other.
[[nodiscard]] const char* unit_by_length(const FileTime& time, const FileTime& other);

// All of them on the samples of the first, as far as the others' times reach: their columns by
// straight lines, those that are folded into a turn unfolded before, with a remark. Columns keep
// their names where one file alone has them, and are "2:name" besides, by the file's number from 1.
// Where one of the others has a gap of more than `most_gap` of its median steps, its columns are
// NaN. Throws InputError where two times share fewer than `fewest` samples of the first.
[[nodiscard]] TimedColumns joined_files(std::vector<TimedColumns> files, Eigen::Index fewest,
                                        double most_gap);

// What such files have, by those names, before any time is taken from them: of the columns no
// values.
[[nodiscard]] NamedColumns named_together(const std::vector<const NamedColumns*>& files);

}  // namespace offnominal::desk
