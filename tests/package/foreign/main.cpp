#include <cstdio>
#include <offnominal/monitor.hpp>
#include <offnominal/version.hpp>

// A pendulum at rest, 1 kg at 0.5 m, that needs 4.905 N m to be held. From tick 500 on the drive
// delivers 1 N m less than it says.
int main() {
  using Monitor = offnominal::Monitor<1, 35, float>;
  Monitor::Config config;
  config.chain.joints[0].axis = {0, 1, 0};
  config.chain.joints[0].centre_of_mass_m = {0.5F, 0, 0};
  config.bound.offset = 1;  // rad/s^2 that the model may be wrong by

  Monitor monitor;
  Monitor::State state;
  Monitor::Output output;
  Monitor::Sample sample;
  sample.tau[0] = -4.905F;
  if (Monitor::create(config, monitor) != offnominal::Status::kOk) return 2;
  if (monitor.reset(sample, state) != offnominal::Status::kOk) return 2;
  for (int tick = 0; tick < 2000; ++tick) {
    if (tick == 500) sample.tau[0] -= 1;
    if (monitor.step(sample, state, output) != offnominal::Status::kOk) return 2;
  }
  if (!output.detector.latched) return 1;
  std::printf("offnominal %d.%d.%d: fault after %.3f s\n", offnominal::kVersionMajor,
              offnominal::kVersionMinor, offnominal::kVersionPatch,
              output.detector.detection_time_s);
  return 0;
}
