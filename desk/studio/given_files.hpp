#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "robot/robot.hpp"
#include "studio/given_recording.hpp"
#include "studio/given_robot.hpp"
#include "studio/said_signals.hpp"
#include "studio/signal_map.hpp"

namespace offnominal::desk::studio {

/// What a page was given, and what is read of it: the robot, which files are one recording, and
/// what the columns are. A copy is cheap: columns that were read are shared. A function that throws
/// leaves half a change behind: change a copy, and keep it once nothing was thrown.
class GivenFiles {
 public:
  [[nodiscard]] const std::optional<GivenRobot>& robot() const { return robot_; }
  [[nodiscard]] const std::vector<GivenRecording>& recordings() const { return recordings_; }
  /// None: there is no robot or no recording.
  [[nodiscard]] const std::optional<ChannelMap>& map() const { return map_; }
  /// The robot file's own [channels], as they are there.
  [[nodiscard]] bool map_is_of_robot() const { return map_is_of_robot_; }

  /// In place of the one before: columns are read and guessed anew, and what was said of them is
  /// said again. Throws InputError where a recording cannot be read with it.
  void use_robot(GivenRobot robot);
  /// A recording, or a part of one; `said` of it before. Throws InputError where it cannot be read,
  /// or has the name of another one.
  void add(std::size_t id, const std::filesystem::path& file, const SaidOfFile& said = {});
  /// Throws Refused where there is no such recording, as all that take an id. Returns its files.
  std::vector<GivenFile> remove(std::size_t id);
  /// The files of one recording become further files of another one.
  void join(std::size_t id, std::size_t to);
  /// Every file of a recording becomes one of its own.
  void split(std::size_t id);
  void set_held_out(std::size_t id, bool held_out);
  void set_payload(std::size_t id, const std::optional<Payload>& payload);
  /// Throws Refused where there is no map yet, and as set_signal() of a map.
  void set_signal(const SignalEdit& edit);
  /// Whether the recordings are hold maps; velocities and times that were said stay said. Throws
  /// Refused where there is no map yet.
  void set_at_rest(bool at_rest);
  /// What was said of the columns is forgotten.
  void guess_again();

  /// By which what is said of the columns is kept: their names, and the robot's joints; empty:
  /// there is no map.
  [[nodiscard]] std::string columns_of() const;
  /// What the user has said of them, also what cannot be said now; null: nothing.
  [[nodiscard]] nlohmann::ordered_json said_of_columns() const;
  /// Says it again, of any JSON. Returns what was said, in words: "the torque of joint 2"; empty:
  /// nothing of it can be said.
  std::string say_of_columns(const nlohmann::ordered_json& said);

  [[nodiscard]] const GivenRecording& recording_of(std::size_t id) const;
  /// As a session reads this recording. Throws Refused where there is no map yet.
  [[nodiscard]] ChannelMap map_of(const GivenRecording& recording) const;

  /// As SignalMap of the API; null: there is no map. `shown`: words as the user may read them.
  [[nodiscard]] nlohmann::ordered_json map_json(
      const std::function<std::string(const std::string&)>& shown) const;

 private:
  // Which files are one recording, but for those of which the user has said so.
  void arrange();
  // Files that were joined by hand before, once both are there.
  void join_as_before();
  // What the columns are, where that is not known.
  void guess();
  // What was said of the map waits for the next one.
  void set_map_aside();
  void take_up();
  void propose();
  // Each file of the first recording by itself: their times are not to be joined yet.
  void propose_apart(const RobotDescription& robot);
  [[nodiscard]] GivenRecording& recording_at(std::size_t id);
  // Those of all recordings, by the first that has them: a session reads all of them by one map.
  [[nodiscard]] MappedColumns columns() const;

  std::optional<GivenRobot> robot_;
  std::vector<GivenRecording> recordings_;
  std::optional<ChannelMap> map_;
  std::set<SignalKey> said_;           // of the map, by hand
  std::optional<bool> said_at_rest_;   // by hand
  std::vector<SaidSignal> waiting_;    // of maps before it, and of columns that are not there now
  std::vector<std::string> of_names_;  // what the map is of: columns of several files, or none
  bool map_is_of_robot_ = false;
  std::string map_source_;  // where the guess comes from, in words
  std::vector<std::string> notes_;
  std::vector<std::string> unread_;  // names of columns without numbers
};

}  // namespace offnominal::desk::studio
