#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/file.hpp"

// What a benchmark of `explain` found of what it had hidden, case by case, in one SQLite file:
// tables `benchmark` (what was run), `cases` and `asked` (of every case what was hidden, and what
// came of it). docs/discovery-benchmark.md has them.

namespace offnominal::desk::benchmark {

/// What became of something that was hidden.
enum class Outcome : std::uint8_t {
  kNamed,    // alone
  kInClass,  // beside what it cannot be told from
  kMissed,
};
inline constexpr int kOutcomes = 3;
/// "named", "in_class", "missed".
[[nodiscard]] const char* name_of(Outcome outcome);

/// An effect that a case hides, and that has to be found.
struct Asked {
  std::string effect;
  int joint = 1;                     // from 1
  std::optional<double> share = {};  // of the joint's torque, root mean square
  Outcome outcome = Outcome::kMissed;
  int class_size = 0;        // 1 where it is named alone, 0 where it is missed
  std::string instead = {};  // of one that is missed: what was said of its joint

  friend bool operator==(const Asked&, const Asked&) = default;
};

struct Case {
  std::int64_t number = 0;  // from 0, in the order of the benchmark
  std::string group;        // as for --cases
  std::uint64_t seed = 0;
  std::string hidden;                   // in words
  std::string said;                     // in words
  std::string verdict;                  // of the whole; empty where there was none
  std::vector<std::string> wrong = {};  // what was named and is not there
  std::string failed = {};              // why there was no answer; empty: there was
  double time_s = 0;                    // of explain() alone
  /// Where robot file and recordings lie, beside the file of the results; empty: nowhere.
  std::string folder = {};
  std::vector<Asked> asked = {};

  friend bool operator==(const Case&, const Case&) = default;
};

struct Results {
  std::string name;     // "discovery", "discovery, arms"
  std::string command;  // that repeats it
  std::uint64_t base_seed = 0;
  std::vector<Case> cases;

  friend bool operator==(const Results&, const Results&) = default;
};

/// Throws InputError for a file that holds no such results, or damaged ones.
[[nodiscard]] Results read_benchmark(const std::filesystem::path& path);

/// Whole or not at all. Throws InputError where it cannot be written.
void write_benchmark(const std::filesystem::path& path, const Results& results, Existing existing);

}  // namespace offnominal::desk::benchmark
