#pragma once

#include <cstddef>

#include "report/page.hpp"

namespace offnominal::desk::report {

/// Fewest points that decimate() can be asked for.
inline constexpr std::size_t kMinDecimatedPoints = 16;

/// `series` with at most `max_points` points (>= kMinDecimatedPoints) for drawing.
/// A series that fits is returned as it is. A longer one is cut into blocks of equal point count;
/// of each block the lowest and the highest point stay (bands: lowest y, highest y_upper), and one
/// gap where the block has one. First and last point stay. Of kPoints those of lowest and highest x
/// stay, too, and half of what is kept is an even sample, so that a cloud stays a cloud.
/// Points are never moved, averaged or reordered. Bars are never reduced.
Series decimate(const Series& series, std::size_t max_points);

}  // namespace offnominal::desk::report
