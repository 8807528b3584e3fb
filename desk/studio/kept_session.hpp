#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "studio/charts.hpp"
#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

/// What the next program that is started over the same files goes on with.
struct SessionState {
  std::vector<Step> steps;                  // from the first on; their ids mean nothing
  std::size_t unknown = 0;                  // steps behind them, which this program does not know
  nlohmann::ordered_json answer = nullptr;  // of the search, as the page has it; null: none
  bool answers_now = false;                 // the answer is of the model with these steps
  std::optional<View> view = {};            // what was looked at last; none: nothing was chosen
};

/// A session's state in a file of its own, written whole after every change: whatever ends the
/// program, no more is lost than the change that it was at. The file belongs to the numbers of the
/// robot file and of the recordings, whatever their names: of others it is left alone, and
/// "a.studio_2.json" is the next name that is tried after "a.studio.json".
class KeptSession {
 public:
  /// Kept nowhere.
  KeptSession() = default;
  /// Beside a recording of that name, there or not; finds what was kept of this input before.
  /// Throws nothing: where it cannot be read or written the session goes on without, and problem()
  /// says so.
  KeptSession(const std::filesystem::path& recording, const Input& input);

  [[nodiscard]] const SessionState& found() const { return found_; }
  /// Of a file that stands where the session would be and cannot be read as one, what came of it,
  /// in words; empty: there is none. It stays as it is: it may be somebody's notes.
  [[nodiscard]] const std::string& damaged() const { return damaged_; }
  void keep(const SessionState& state);
  /// Not all that was found could be taken up: it stays beside the file, as "a.studio.json.before".
  void set_found_aside();
  /// Empty: kept nowhere.
  [[nodiscard]] std::string file() const { return file_.string(); }
  /// Why the last change is not in the file, in words; empty: it is.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  std::filesystem::path file_;
  std::string of_;
  SessionState found_;
  std::string problem_;
  std::string damaged_;
};

/// {joint, recording, beside, from, to}, counted from 1, of what is not there null; and back, of
/// anything. Throws nlohmann::json::exception where it is none.
[[nodiscard]] nlohmann::ordered_json json_of(const View& view);
[[nodiscard]] View view_from(const nlohmann::ordered_json& json);

/// Of the numbers that a session is over: the robot, and every sample of every recording.
[[nodiscard]] std::uint64_t fingerprint_of(const Input& input);

}  // namespace offnominal::desk::studio
