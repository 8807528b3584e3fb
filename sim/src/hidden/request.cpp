#include "offnominal/sim/hidden/request.hpp"

#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

namespace offnominal::sim::hidden {
namespace {

void require(bool good, const char* field, double found, const char* allowed) {
  if (good) return;
  throw std::invalid_argument(std::string("request ") + field + ": found " + std::to_string(found) +
                              ", allowed is " + allowed);
}

}  // namespace

void validate(const Request& r) {
  require(r.effect_size > 0.0 && std::isfinite(r.effect_size), "effect_size", r.effect_size,
          "above 0");
  require(r.torque_noise_share >= 0.0 && std::isfinite(r.torque_noise_share), "torque_noise_share",
          r.torque_noise_share, "0 or more");
  require(r.encoder_bits >= 1 && r.encoder_bits <= 32, "encoder_bits", r.encoder_bits, "1 to 32");
  require(r.duration_s > 0.0 && r.duration_s <= 1e5, "duration_s", r.duration_s,
          "above 0, up to 1e5");
  require(r.sample_rate_hz >= 100.0 && r.sample_rate_hz <= 1e4, "sample_rate_hz", r.sample_rate_hz,
          "100 to 10000");
  std::set<HiddenEffect> seen;
  for (const HiddenEffect effect : r.effects) {
    if (seen.insert(effect).second) continue;
    throw std::invalid_argument("request effects: found " + std::string(name(effect)) +
                                " twice, allowed is once");
  }
}

std::string_view name(DataFault fault) {
  switch (fault) {
    case DataFault::kNone:
      return "none";
    case DataFault::kDegrees:
      return "degrees";
    case DataFault::kSwappedTorqueSign:
      return "swapped_torque_sign";
    case DataFault::kStaleSamples:
      return "stale_samples";
    case DataFault::kClockSkew:
      return "clock_skew";
  }
  return "";
}

}  // namespace offnominal::sim::hidden
