#include <cstdio>
#include <offnominal/hal/bus/socketcan.hpp>
#include <offnominal/hal/bus/virtual_can.hpp>
#include <offnominal/realtime/cycle_timer.hpp>
#include <offnominal/realtime/privileges.hpp>
#include <offnominal/realtime/recorder.hpp>
#include <offnominal/realtime/signals.hpp>

// What a controller program of one's own on Linux takes of the package, linked and called.
int main() {
  namespace hal = offnominal::hal;
  namespace realtime = offnominal::realtime;
  hal::SocketCan bus;
  if (bus.open({.interface = "none0"}) == hal::Status::kOk) return 1;
  const realtime::Signals signals;
  realtime::Recorder recorder;
  realtime::CycleTimer timer(1000, 0);
  const realtime::Tick tick = timer.wait();
  static_cast<void>(realtime::ask_for({.priority = 0}));
  recorder.close();
  if (tick.begin_us <= 0 || recorder.lost() != 0) return 1;
  std::printf("a tick on Linux\n");
  return 0;
}
