#include "offnominal/sim/encoder.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace offnominal::sim {
namespace {

JointVector quantise(const JointVector& value, double step) {
  return value.unaryExpr([step](double one) { return sim::quantise(one, step); });
}

}  // namespace

double quantise(double value, double step) {
  return step == 0.0 ? value : step * std::round(value / step);
}

double position_step_rad(const EncoderConfig& config) {
  return config.bits_per_turn == 0 ? 0.0
                                   : std::ldexp(2.0 * std::numbers::pi, -config.bits_per_turn);
}

Encoders::Encoders(const EncoderConfig& config) : config_(config) {
  if (config.bits_per_turn < 0 || config.bits_per_turn > 52) {
    throw std::invalid_argument("encoder bits_per_turn: found " +
                                std::to_string(config.bits_per_turn) + ", allowed is 0 to 52");
  }
  const double step = config.velocity_step_rad_s;
  if (config.velocity == VelocitySource::kQuantised && !(step > 0.0 && std::isfinite(step))) {
    throw std::invalid_argument("encoder velocity_step_rad_s: found " + std::to_string(step) +
                                ", allowed is above 0");
  }
}

JointState Encoders::measure(const JointState& truth, double period_s) {
  if (!(period_s > 0.0)) {
    throw std::invalid_argument("encoder period_s: found " + std::to_string(period_s) +
                                ", allowed is above 0");
  }
  const double count = position_step_rad(config_);
  JointState measured{quantise(truth.q, count), truth.dq};
  if (config_.velocity == VelocitySource::kQuantised) {
    measured.dq = quantise(truth.dq, config_.velocity_step_rad_s);
  } else if (config_.velocity == VelocitySource::kBackwardDifference) {
    if (last_q_.size() > 0) {
      measured.dq = (measured.q - last_q_) / period_s;
    } else {
      measured.dq = quantise(truth.dq, count / period_s);
    }
  }
  last_q_ = measured.q;
  return measured;
}

}  // namespace offnominal::sim
