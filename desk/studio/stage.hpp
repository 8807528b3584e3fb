#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "live/live.hpp"
#include "studio/intake.hpp"
#include "studio/results_view.hpp"
#include "studio/session.hpp"
#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

/// Reads a recording that the live view has written, as the verb reads its own.
using OpenRecording = std::function<Input(const std::string& file)>;

/// What the server shows: a session over recordings, or what leads to one: files that the page is
/// given, runs of a campaign or a benchmark, or a live view that hands stretches over. Every
/// function may be called by any thread.
class Stage {
 public:
  explicit Stage(Input input);
  Stage(std::unique_ptr<live::Live> live, OpenRecording open);
  Stage(std::unique_ptr<Intake> intake, OpenFiles open);
  Stage(std::unique_ptr<ResultsView> results, OpenFiles open);

  /// Throws Refused as long as no recording is loaded.
  [[nodiscard]] std::shared_ptr<Session> session() const;
  /// Throws Refused where there is no live view.
  [[nodiscard]] live::Live& live() const;
  [[nodiscard]] bool is_live() const { return live_ != nullptr; }
  /// Throws Refused where the files are those of the command line.
  [[nodiscard]] Intake& intake() const;
  [[nodiscard]] bool takes_files() const { return intake_ != nullptr; }
  /// Throws Refused where there is none.
  [[nodiscard]] ResultsView& results() const;
  [[nodiscard]] bool has_results() const { return results_ != nullptr; }
  [[nodiscard]] bool is_loaded() const;
  /// Counts the sessions that were shown; 0: none was. A page sees by it that another one has begun
  /// one.
  [[nodiscard]] std::size_t session_number() const;

  /// What came since the last detection becomes a recording, that one the session's, and the search
  /// for what the model lacks there begins. Throws Refused where nothing was detected, InputError
  /// where the recording cannot be written or will not do; the session before stays. Of a detection
  /// whose session is shown already nothing is begun anew.
  nlohmann::ordered_json explain_detection();
  /// The files that the page was given become the session's: {written: [names]}. Throws Refused
  /// where something is missing, and where a session with steps would be lost and `replace` does
  /// not say that this is meant; InputError where they will not do; the session before stays.
  nlohmann::ordered_json use_files(bool replace);
  /// A run of the results becomes the session's recording: {run}. Throws as use_files().
  nlohmann::ordered_json open_run(std::int64_t run, bool replace);
  /// The page is gone, or the server ends: no search goes on in the background.
  void leave() const;

 private:
  void check_nothing_is_lost(bool replace) const;
  // The session that is shown is another one from now on.
  void show(std::shared_ptr<Session> made);

  OpenRecording open_;
  OpenFiles open_files_;
  std::mutex making_;              // one session after the other
  live::Live::Written explained_;  // the detection that the session is over; number 0: none
  mutable std::mutex lock_;        // of the session that is shown
  std::shared_ptr<Session> session_;
  std::size_t shown_ = 0;  // sessions, up to this one
  std::unique_ptr<Intake> intake_;
  std::unique_ptr<ResultsView> results_;
  std::unique_ptr<live::Live> live_;  // ends first
};

}  // namespace offnominal::desk::studio
