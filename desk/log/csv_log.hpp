#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "log/named_columns.hpp"
#include "log/recording_file.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// A text file with one line of numbers per sample, cells parted by commas, semicolons, tabs or
// runs of blanks, with a decimal point, or a comma where commas part nothing. What stands before
// the samples (csv_layout.hpp): a header line of names, one behind a '#' right above the samples,
// or none, and columns are then named by their numbers, "1", "2" ...; a line of units. A column may
// be asked for by its number in any case, and in small letters where a header has none. Lines
// behind '#' or '%', blank lines before the samples and after them, quotes, spaces around values, a
// byte order mark, either kind of line end, a separator behind the last cell, an unnamed first
// column and row names are understood. A column of time may hold dates in ISO 8601, its date or its
// time of day alone where another column has the other half, and numbers too long for a double,
// such as nanoseconds since 1970: it counts from the first then (TimeOrigin). Throws InputError
// with the line and the column for text in a number, a line with too few or too many values, a
// blank line between samples, an unnamed or repeated column, a file that is empty or holds a header
// only. A last line that has no end and too few values is left out, with a remark: a writer was
// killed. Where no column is needed the samples are not read. `channels` say nothing that it has to
// know.
NamedColumns read_csv(RecordingFile& file, const ChannelMap* channels, const NeedOf& need_of);
NamedColumns read_csv(const std::filesystem::path& path, const NeedOf& need_of);

// What a text in a cell of `column` that is no number means all the same; none: nothing. May throw
// InputError; `place` is where it stands.
using MeaningOf = std::function<std::optional<double>(
    const std::string& place, const std::string& column, const std::string& text)>;
NamedColumns read_csv(const std::filesystem::path& path, const NeedOf& need_of,
                      const MeaningOf& meaning_of);

}  // namespace offnominal::desk
