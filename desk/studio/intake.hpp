#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "explain/data_fault.hpp"
#include "robot/robot.hpp"
#include "studio/given_files.hpp"
#include "studio/given_robot.hpp"
#include "studio/kept_columns.hpp"
#include "studio/session_files.hpp"
#include "studio/signal_map.hpp"
#include "studio/upload_folder.hpp"

namespace offnominal::desk::studio {

struct IntakeSettings {
  std::optional<std::string> robot_file = {};  // of the command line
  std::filesystem::path folder = {};           // where files are written; empty: working directory
  std::vector<KeepFault> keep = {};
  bool keeps_columns =
      true;  // what is said of dropped files, in studio_columns.json in that folder
  UploadLimits limits = {};
};

/// What a page is given before there is a session: recordings, a robot file, and what the columns
/// are. Every function may be called by any thread, answers as docs/studio.md has it, and throws
/// Refused or InputError where it cannot be done; nothing has changed then.
class Intake {
 public:
  /// Throws InputError where the robot file cannot be read.
  explicit Intake(IntakeSettings settings);

  [[nodiscard]] UploadFolder& folder() { return folder_; }
  [[nodiscard]] nlohmann::ordered_json state();
  /// A file that was handed over: a robot file (.toml), a URDF (.urdf) or a recording. One that
  /// cannot be read is gone. Of a URDF that has several chains of joints, one is chosen by
  /// choose_chain(); until then the robot before stays. A robot takes the place of the one before,
  /// and the columns are guessed anew.
  nlohmann::ordered_json take(const std::filesystem::path& file);
  /// Of the URDF that was handed over last, where it has several chains, the robot of one, from 0.
  nlohmann::ordered_json choose_chain(std::size_t chain);
  /// A recording, with all of its files.
  nlohmann::ordered_json remove(std::size_t id);
  /// The files of one recording become further files of another one.
  nlohmann::ordered_json join(std::size_t id, std::size_t to);
  /// Every file of a recording becomes a recording of its own.
  nlohmann::ordered_json split(std::size_t id);
  nlohmann::ordered_json set_held_out(std::size_t id, bool held_out);
  /// What a recording carried, where that is known; none: what the robot file says of it, if
  /// anything.
  nlohmann::ordered_json set_payload(std::size_t id, const std::optional<Payload>& payload);
  nlohmann::ordered_json set_signal(const SignalEdit& edit);
  /// What was said of the columns is forgotten.
  nlohmann::ordered_json set_at_rest(bool at_rest);
  nlohmann::ordered_json guess_again();
  [[nodiscard]] nlohmann::ordered_json preview(std::size_t id, std::size_t pixels);
  [[nodiscard]] nlohmann::ordered_json findings(std::size_t id, std::size_t pixels);

  /// What a session is to begin with. Throws Refused where something is missing, and where the
  /// recordings are hold maps.
  [[nodiscard]] SessionFiles files();
  /// Of hold maps, over which there is no session: writes as write() does. Returns {written,
  /// commands, note}. Throws Refused where something is missing, or they are recordings in time;
  /// InputError where one of them cannot be read.
  nlohmann::ordered_json write_at_rest();
  /// Writes what the session's commands name: a robot file that was handed over, and [channels]
  /// that the robot file does not have. Returns their names.
  std::vector<std::string> write(const SessionFiles& files);

 private:
  [[nodiscard]] nlohmann::ordered_json state_now() const;
  // Changes what was given, or throws and changes nothing.
  nlohmann::ordered_json change(const std::function<void(GivenFiles&)>& work);
  // What was said of the same columns before is said again, and what is said now is kept.
  void take_up(GivenFiles& changed);
  void keep(const GivenFiles& changed);
  void take_urdf(GivenFiles& given, const std::filesystem::path& file);
  void forget_urdf();
  void use_robot(GivenFiles& given, GivenRobot robot);
  [[nodiscard]] SessionFiles files_now();
  [[nodiscard]] std::string free_name(const std::string& stem, const std::string& ending) const;
  [[nodiscard]] NamedFile robot_to_use() const;
  [[nodiscard]] NamedFile recording_to_use(const GivenRecording& recording,
                                           std::string& note) const;
  [[nodiscard]] std::filesystem::path here(const std::string& name) const;

  std::mutex lock_;
  IntakeSettings settings_;
  UploadFolder folder_;
  std::optional<GivenUrdf> urdf_;  // the last one, where it has several chains
  GivenFiles given_;
  KeptColumns kept_;
  std::string taken_up_;  // of the columns, from a program before, in words
  std::size_t next_id_ = 1;
  std::size_t revision_ = 0;
};

}  // namespace offnominal::desk::studio
