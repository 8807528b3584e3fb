#pragma once

#include "log/named_columns.hpp"
#include "log/recording_file.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// True where the file begins like a MATLAB .mat file (levels 5 and 7.3), or has that extension.
bool is_mat_file(const RecordingFile& file);

// The numeric variables of a MATLAB .mat file: a row or column vector is a column, a single number
// a scalar, and so is each value of a short vector, "u(3)". The columns of a matrix M are "M(:,1)",
// "M(:,2)" ..., its rows "M(1,:)" ...; what a structure s holds is "s.field", at any depth, and
// "s(2).field" where there are several. Variables of other kinds (cells, text, complex numbers,
// objects) are named but not read. Throws InputError where the file cannot be read, is damaged, or
// a required variable is not of those kinds. `channels` say nothing that it has to know.
NamedColumns read_mat(RecordingFile& file, const ChannelMap* channels, const NeedOf& need_of);

}  // namespace offnominal::desk
