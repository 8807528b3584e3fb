#include "identify/freedom.hpp"

#include <fmt/format.h>

#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace offnominal::desk {

double half_width_per_deviation(const Freedom& freedom) {
  constexpr double kUpper = 0.975;
  const double free = freedom.free();
  const boost::math::students_t distribution(free);
  return boost::math::quantile(distribution, kUpper) * std::sqrt(freedom.groups / free);
}

std::string words_of_too_few(const Freedom& freedom, std::size_t joint) {
  return fmt::format(
      "no interval: {} fitted numbers of joint {} need {} independent stretches of the recording "
      "that tell of it or more, found {}; record for longer",
      freedom.unknowns, joint + 1, freedom.unknowns + Freedom::kFewestFree, freedom.groups);
}

}  // namespace offnominal::desk
