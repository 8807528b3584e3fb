#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "exchange/chain_request.hpp"
#include "robot/robot.hpp"
#include "studio/session_files.hpp"

// The robot of what a page is given, from whichever kind of file.

namespace offnominal::desk::studio {

class UploadFolder;

/// A robot, and the file that says it. `file.name`: by the name alone.
struct GivenRobot {
  RobotDescription description;
  NamedFile file;
  std::vector<std::string> notes = {};  // of its import
  std::string import_command = {};      // the command that chose its chain, but for -o; or empty
};

/// Of a robot file. Throws InputError where it cannot be read, and where it names another file,
/// which would be one of this machine.
[[nodiscard]] GivenRobot robot_of_toml(const std::filesystem::path& file);

/// {name, file, joints: [{joint, name}], notes}.
[[nodiscard]] nlohmann::ordered_json to_json(const GivenRobot& robot);

/// A URDF and the chains of joints that it has.
class GivenUrdf {
 public:
  /// Throws InputError where it cannot be read.
  explicit GivenUrdf(std::filesystem::path file);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  /// The user has to say which of its chains is meant.
  [[nodiscard]] bool has_choice() const { return chains_.size() > 1; }
  /// The robot of the only chain.
  [[nodiscard]] GivenRobot robot(UploadFolder& folder) const;
  /// The robot of a chain, from 0, as a file in `folder`. Throws Refused where there is none of
  /// that number, InputError where `import-urdf` refuses it.
  [[nodiscard]] GivenRobot robot(std::size_t chain, UploadFolder& folder) const;
  /// Which one is used.
  void choose(std::size_t chain) { chosen_ = chain; }

  /// {file, chains: [{base, tip, joints}], chosen}.
  [[nodiscard]] nlohmann::ordered_json json() const;

 private:
  [[nodiscard]] GivenRobot import_chain(const exchange::ChainRequest& request,
                                        UploadFolder& folder) const;

  std::filesystem::path file_;
  std::string text_;
  std::vector<exchange::ChainChoice> chains_;
  std::optional<std::size_t> chosen_;
};

}  // namespace offnominal::desk::studio
