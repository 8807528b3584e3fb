#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/file.hpp"
#include "exchange/chain_request.hpp"
#include "support/places.hpp"
#include "support/recordings.hpp"

namespace offnominal::test {

/// A URDF and the chain of it that a test is about.
struct UrdfCase {
  std::string name;  // a word
  std::filesystem::path file;
  std::string base;
  std::string tip;
  int joints = 0;

  [[nodiscard]] std::string text() const { return desk::read_text_file(file); }
  [[nodiscard]] desk::exchange::ChainRequest chain() const { return {base, tip}; }
};

/// One of everything between two links, written for the tests.
inline UrdfCase sample_arm() {
  return {"Sample", source_dir() / "tests" / "fuzz" / "corpus" / "urdf" / "arm.urdf", "world",
          "hand", 3};
}

/// Of real robots, which may be absent.
inline std::vector<UrdfCase> all_urdfs() {
  const std::filesystem::path folder = recordings_dir();
  return {sample_arm(),
          {"DoublePendulum", folder / "urdf" / "double_pendulum.urdf", "base_link", "link2", 2},
          {"Panda", folder / "urdf" / "panda.urdf", "panda_link0", "panda_hand", 7},
          {"PandaForearm", folder / "urdf" / "panda.urdf", "panda_link3", "panda_link7", 4},
          {"Ur5", folder / "urdf" / "ur5_robot.urdf", "world", "tool0", 6},
          {"Pendulum", folder / "dfki_pendulum" / "dfki_simple_pendulum.urdf", "base_link",
           "Link_1", 1}};
}

}  // namespace offnominal::test

// In a test of one of all_urdfs(): skipped, with the reason, where the file is absent.
#define OFFNOMINAL_SKIP_WITHOUT(urdf)                                                     \
  if (!std::filesystem::exists((urdf).file)) {                                            \
    GTEST_SKIP() << "no URDF at " << (urdf).file << "; OFFNOMINAL_DATA names its folder"; \
  }
