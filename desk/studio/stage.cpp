#include "studio/stage.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "common/refused.hpp"

namespace offnominal::desk::studio {

Stage::Stage(Input input) : session_(std::make_shared<Session>(std::move(input))) {}

Stage::Stage(std::unique_ptr<live::Live> live, OpenRecording open)
    : open_(std::move(open)), live_(std::move(live)) {}

std::shared_ptr<Session> Stage::session() const {
  const std::lock_guard guard(lock_);
  if (session_) return session_;
  throw Refused(Refused::Why::kNotNow,
                "No recording is loaded yet: once something is detected, have it explained.");
}

bool Stage::is_loaded() const {
  const std::lock_guard guard(lock_);
  return session_ != nullptr;
}

live::Live& Stage::live() const {
  if (live_) return *live_;
  throw Refused(
      Refused::Why::kNotNow,
      "This session is over recordings: start Studio with --sil or --bus for a live view.");
}

nlohmann::ordered_json Stage::explain_detection() {
  const std::lock_guard guard(explaining_);
  const live::Live::Written written = live().write_detection();
  auto made = std::make_shared<Session>(open_(written.since));
  static_cast<void>(made->start_to_explain());
  std::shared_ptr<Session> before;
  {
    const std::lock_guard shown(lock_);
    before = std::exchange(session_, std::move(made));
  }
  if (before) before->leave();
  return {{"saved", written.since}, {"before", written.before}};
}

void Stage::leave() const {
  const std::lock_guard guard(lock_);
  if (session_) session_->leave();
}

}  // namespace offnominal::desk::studio
