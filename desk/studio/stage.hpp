#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "live/live.hpp"
#include "studio/session.hpp"
#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

/// Reads a recording that the live view has written, as the verb reads its own.
using OpenRecording = std::function<Input(const std::string& file)>;

/// What the server shows: a session over recordings, or a live view that hands stretches over to
/// one. Every function may be called by any thread.
class Stage {
 public:
  explicit Stage(Input input);
  Stage(std::unique_ptr<live::Live> live, OpenRecording open);

  /// Throws Refused as long as no recording is loaded.
  [[nodiscard]] std::shared_ptr<Session> session() const;
  /// Throws Refused where there is no live view.
  [[nodiscard]] live::Live& live() const;
  [[nodiscard]] bool is_live() const { return live_ != nullptr; }
  [[nodiscard]] bool is_loaded() const;

  /// What came since the last detection becomes a recording, that one the session's, and the search
  /// for what the model lacks there begins. Throws Refused where nothing was detected, InputError
  /// where the recording cannot be written or will not do; the session before stays.
  nlohmann::ordered_json explain_detection();
  /// The page is gone, or the server ends: no search goes on in the background.
  void leave() const;

 private:
  OpenRecording open_;
  std::mutex explaining_;    // one after the other
  mutable std::mutex lock_;  // of the session that is shown
  std::shared_ptr<Session> session_;
  std::unique_ptr<live::Live> live_;  // ends first
};

}  // namespace offnominal::desk::studio
