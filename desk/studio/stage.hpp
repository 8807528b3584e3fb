#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "live/live.hpp"
#include "studio/intake.hpp"
#include "studio/session.hpp"
#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

/// Reads a recording that the live view has written, as the verb reads its own.
using OpenRecording = std::function<Input(const std::string& file)>;

/// What the server shows: a session over recordings, or what leads to one: files that the page is
/// given, or a live view that hands stretches over. Every function may be called by any thread.
class Stage {
 public:
  explicit Stage(Input input);
  Stage(std::unique_ptr<live::Live> live, OpenRecording open);
  Stage(std::unique_ptr<Intake> intake, OpenFiles open);

  /// Throws Refused as long as no recording is loaded.
  [[nodiscard]] std::shared_ptr<Session> session() const;
  /// Throws Refused where there is no live view.
  [[nodiscard]] live::Live& live() const;
  [[nodiscard]] bool is_live() const { return live_ != nullptr; }
  /// Throws Refused where the files are those of the command line.
  [[nodiscard]] Intake& intake() const;
  [[nodiscard]] bool takes_files() const { return intake_ != nullptr; }
  [[nodiscard]] bool is_loaded() const;

  /// What came since the last detection becomes a recording, that one the session's, and the search
  /// for what the model lacks there begins. Throws Refused where nothing was detected, InputError
  /// where the recording cannot be written or will not do; the session before stays.
  nlohmann::ordered_json explain_detection();
  /// The files that the page was given become the session's: {written: [names]}. Throws Refused
  /// where something is missing, and where a session with steps would be lost and `replace` does
  /// not say that this is meant; InputError where they will not do; the session before stays.
  nlohmann::ordered_json use_files(bool replace);
  /// The page is gone, or the server ends: no search goes on in the background.
  void leave() const;

 private:
  // The session that is shown is another one from now on.
  void show(std::shared_ptr<Session> made);

  OpenRecording open_;
  OpenFiles open_files_;
  std::mutex making_;        // one session after the other
  mutable std::mutex lock_;  // of the session that is shown
  std::shared_ptr<Session> session_;
  std::unique_ptr<Intake> intake_;
  std::unique_ptr<live::Live> live_;  // ends first
};

}  // namespace offnominal::desk::studio
