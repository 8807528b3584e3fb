#include <benchmark/benchmark.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <string>

#include "log/read_log.hpp"

// How fast a CSV file becomes a Log, on one core, and how much memory that takes beside the numbers
// themselves: seven joints, time, positions, velocities and torques, printed with 9 digits as most
// recorders do. OFFNOMINAL_BENCH_ROWS sets the rows, 10 million of which have 4 GB of text.

namespace offnominal::bench {
namespace {

constexpr int kJoints = 7;
constexpr std::int64_t kDefaultRows = 200'000;

std::int64_t rows_asked_for() {
  const char* const text = std::getenv("OFFNOMINAL_BENCH_ROWS");
  const std::int64_t rows = text == nullptr ? kDefaultRows : std::atoll(text);
  return rows > 0 ? rows : kDefaultRows;
}

// A file in the folder for temporary files that goes with the program.
class Recording {
 public:
  explicit Recording(std::int64_t rows)
      : path_(std::filesystem::temp_directory_path() /
              ("offnominal-bench-" + std::to_string(::getpid()) + ".csv")) {
    std::ofstream file(path_, std::ios::binary);
    file << "t";
    for (const char* name : {"q", "dq", "tau"}) {
      for (int joint = 1; joint <= kJoints; ++joint) file << ',' << name << joint;
    }
    file << '\n';
    std::mt19937_64 generator(1);
    std::normal_distribution<double> normal;
    std::string line;
    for (std::int64_t i = 0; i < rows; ++i) {
      char number[40];
      line.assign(number, static_cast<std::size_t>(std::snprintf(number, sizeof number, "%.3f",
                                                                 0.001 * static_cast<double>(i))));
      for (int column = 0; column < 3 * kJoints; ++column) {
        const int size = std::snprintf(number, sizeof number, ",%.9g", normal(generator));
        line.append(number, static_cast<std::size_t>(size));
      }
      line += '\n';
      file << line;
    }
    file.close();
    if (!file) {
      std::fprintf(stderr, "no room for the benchmark's recording in %s\n", path_.c_str());
      std::exit(2);
    }
  }
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;
  ~Recording() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

double peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

void read_csv_recording(benchmark::State& state, const Recording& recording, double before_bytes) {
  Eigen::Index samples = 0;
  for (auto _ : state) {
    const desk::Log log = desk::read_log(recording.path(), kJoints, std::nullopt);
    samples = log.sample_count();
    benchmark::DoNotOptimize(log.q.data());
  }
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(recording.path()));
  state.SetBytesProcessed(state.iterations() * size);
  const double numbers = 8.0 * static_cast<double>(samples) * (3 * kJoints + 1);
  state.counters["memory_per_numbers"] = (peak_memory_bytes() - before_bytes) / numbers;
}

}  // namespace
}  // namespace offnominal::bench

int main(int argc, char** argv) {
  using namespace offnominal::bench;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const Recording recording(rows_asked_for());
  const double before_bytes = peak_memory_bytes();
  benchmark::RegisterBenchmark("recording/csv_of_seven_joints", [&](benchmark::State& state) {
    read_csv_recording(state, recording, before_bytes);
  })->Unit(benchmark::kMillisecond);
  std::printf("a CSV file as a Log; the goal is 150 MB/s and 1.3 times the numbers' own memory\n");
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
