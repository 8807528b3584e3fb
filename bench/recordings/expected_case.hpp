#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

// What is known of recordings of real machines: expectations.toml, which says how it is written.

namespace offnominal::bench {

struct Claim {
  enum class Kind { kNames, kNever, kNothingFound, kNumber, kLeft, kVerdict, kOver, kFault };
  Kind kind = Kind::kNames;
  std::optional<int> joint;        // from 1; none: of the whole answer
  std::vector<std::string> words;  // effects, verdicts; one variable, one part of a fault's words
  std::optional<double> order;     // of a cogging torque
  double from = 0;                 // kNumber
  double to = 0;                   // kNumber; kLeft: the most
  std::string text;                // "joint 1: names viscous_friction"
};

struct ExpectedCase {
  std::string name;
  std::string robot;
  std::vector<std::string> logs;
  std::vector<std::string> holdout;
  std::string source;
  std::vector<Claim> claims;
};

// Throws InputError where the file is wrong, an effect has no such name among them.
[[nodiscard]] std::vector<ExpectedCase> read_expectations(const std::filesystem::path& file);

}  // namespace offnominal::bench
