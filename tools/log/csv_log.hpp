#pragma once

#include <filesystem>

#include "log/named_columns.hpp"
#include "log/recording_file.hpp"
#include "robot/robot.hpp"

namespace offnominal::tools {

// A text file with one header line and then one line of numbers per sample, separated by commas
// (or by semicolons or tabs, where the header has no comma). Quotes, spaces around values, a byte
// order mark and either kind of line end are understood. Throws InputError with the line and the
// column for text in a number, a line with too few or too many values, a blank line between
// samples, an unnamed or repeated column, a file that is empty or holds a header only. A last line
// that has no end and too few values is left out, with a remark: a writer was killed. Where no
// column is needed the samples are not read. `channels` say nothing that it has to know.
NamedColumns read_csv(RecordingFile& file, const ChannelMap* channels, const NeedOf& need_of);
NamedColumns read_csv(const std::filesystem::path& path, const NeedOf& need_of);

}  // namespace offnominal::tools
