#include <benchmark/benchmark.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <offnominal/hal/bus/in_process_bus.hpp>
#include <offnominal/hal/protocols/protected/protected_drives.hpp>

#include "heap_counter.hpp"
#include "ratio_table.hpp"

// What a frame costs a controller: made and packed, carried by the in-process bus, taken in with
// all its checks (identifier, length, format, CRC, content, counter, age).

namespace offnominal::bench {
namespace {

constexpr std::size_t kJoints = 8;
constexpr hal::SourceConfig kSource{.max_age_us = 2500};
using Drives = hal::ProtectedDrives<kJoints>;

void require(bool good) {
  if (good) return;
  std::fprintf(stderr, "benchmark set-up failed\n");
  std::exit(2);
}

template <typename Body>
void measure(benchmark::State& state, std::int64_t frames_per_iteration, Body&& body) {
  std::uint64_t calls = 0;
  const std::uint64_t before = heap_calls();
  for (auto _ : state) {
    body();
    calls = heap_calls() - before;
  }
  state.counters["heap_calls"] = static_cast<double>(calls);
  state.counters["per_frame"] =
      benchmark::Counter(static_cast<double>(frames_per_iteration * state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// One encoder reading: to a record, to a frame, and back with every check.
void one_frame(benchmark::State& state) {
  Drives drives(kSource, kSource, hal::FrameFormat::kClassic);
  const std::uint16_t id = data_id_of(hal::MessageKind::kEncoder, 0);
  std::uint8_t counter = 0;
  hal::Microseconds now_us = 0;
  float position = 0;
  const auto round_trip = [&] {
    hal::Record record{};
    position = position < 1 ? position + 0.001F : 0;
    static_cast<void>(encode(hal::EncoderReading{position, 0.5F, true}, counter++, id, record));
    const hal::ReceivedFrame received{frame_of(hal::MessageKind::kEncoder, 0, record),
                                      now_us += 1000};
    const hal::Status status = drives.take(received);
    const hal::JointFeedback feedback = drives.feedback(0, now_us);
    benchmark::DoNotOptimize(feedback);
    return status;
  };
  for (int i = 0; i < 3; ++i) static_cast<void>(round_trip());
  require(round_trip() == hal::Status::kOk);
  measure(state, 1, [&] { benchmark::DoNotOptimize(round_trip()); });
  require(drives.feedback(0, now_us).encoder == hal::SourceState::kValid);
}

// A tick's commands to eight drives over the bus: `per_frame` is what one of the frames costs.
void commands(benchmark::State& state, hal::FrameFormat format) {
  using Net = hal::InProcessNet<2>;
  Net net;
  Net::Port sender = net.port(0);
  Net::Port receiver = net.port(1);
  Drives drives(kSource, kSource, format);
  hal::Inbox<hal::TorqueCommand, kJoints> inbox;
  std::array<hal::TorqueCommand, kJoints> wanted;
  wanted.fill({hal::DriveMode::kTorque, 1.5F});
  std::uint32_t accepted = 0;
  std::int64_t frames_per_tick = 0;
  const auto tick = [&] {
    std::array<hal::Frame, Drives::kMaxOutgoing> outgoing;
    // Not a tick with a heartbeat.
    const std::size_t count =
        drives.outgoing(wanted, {hal::ControllerState::kArmed, 0, 1}, outgoing);
    frames_per_tick = static_cast<std::int64_t>(count);
    for (std::size_t i = 0; i < count; ++i) static_cast<void>(sender.send(outgoing[i], net.now()));
    std::array<hal::ReceivedFrame, kJoints> come;
    const std::size_t fetched = receiver.receive(come);
    for (std::size_t i = 0; i < fetched; ++i) {
      hal::Address address;
      if (address_of(come[i].frame, address) != hal::Status::kOk) continue;
      for (std::size_t k = 0; k < address.count; ++k) {
        const std::size_t node = address.first_node + k;
        const auto status =
            inbox.take(kSource, address.kind, node, record_in(come[i].frame, k), come[i].time_us);
        accepted += status == hal::Status::kOk ? 1U : 0U;
      }
    }
  };
  for (int i = 0; i < 3; ++i) tick();
  require(accepted == kJoints);
  measure(state, frames_per_tick, tick);
}

void register_all() {
  const auto add = [](const char* name, auto function) {
    benchmark::RegisterBenchmark(name, function)->Repetitions(9)->ReportAggregatesOnly(true);
  };
  add("frame/encoder_there_and_back", one_frame);
  add("frame/eight_commands_classic",
      [](benchmark::State& state) { commands(state, hal::FrameFormat::kClassic); });
  add("frame/eight_commands_in_one_fd",
      [](benchmark::State& state) { commands(state, hal::FrameFormat::kFd); });
}

}  // namespace
}  // namespace offnominal::bench

int main(int argc, char** argv) {
  using namespace offnominal::bench;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  register_all();
  RatioReporter reporter({{"eight_commands_classic", "frame/encoder_there_and_back"},
                          {"eight_commands_in_one_fd", "frame/encoder_there_and_back"}});
  std::printf("frames with counter and CRC; the goal is 1000 ns for one\n");
  benchmark::RunSpecifiedBenchmarks(&reporter);
  reporter.print_table();
  benchmark::Shutdown();
  return 0;
}
