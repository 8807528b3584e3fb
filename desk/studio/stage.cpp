#include "studio/stage.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "common/error.hpp"
#include "common/refused.hpp"

namespace offnominal::desk::studio {

Stage::Stage(Input input) : session_(std::make_shared<Session>(std::move(input))), shown_(1) {}

Stage::Stage(std::unique_ptr<live::Live> live, OpenRecording open)
    : open_(std::move(open)), live_(std::move(live)) {}

Stage::Stage(std::unique_ptr<Intake> intake, OpenFiles open)
    : open_files_(std::move(open)), intake_(std::move(intake)) {}

Stage::Stage(std::unique_ptr<ResultsView> results, OpenFiles open)
    : open_files_(std::move(open)), results_(std::move(results)) {}

std::shared_ptr<Session> Stage::session() const {
  const std::lock_guard guard(lock_);
  if (session_) return session_;
  if (intake_) {
    throw Refused(Refused::Why::kNotNow,
                  "No recording is loaded yet: drop a recording and a robot file, and use them.");
  }
  if (results_) {
    throw Refused(Refused::Why::kNotNow, "No run is open yet: choose one of the list.");
  }
  throw Refused(Refused::Why::kNotNow,
                "No recording is loaded yet: once something is detected, have it explained.");
}

bool Stage::is_loaded() const {
  const std::lock_guard guard(lock_);
  return session_ != nullptr;
}

std::size_t Stage::session_number() const {
  const std::lock_guard guard(lock_);
  return shown_;
}

live::Live& Stage::live() const {
  if (live_) return *live_;
  throw Refused(
      Refused::Why::kNotNow,
      "This session is over recordings: start Studio with --sil or --bus for a live view.");
}

Intake& Stage::intake() const {
  if (intake_) return *intake_;
  throw Refused(Refused::Why::kNotNow,
                "The files of this session are those of the command line: start Studio without a "
                "recording to drop some.");
}

nlohmann::ordered_json Stage::explain_detection() {
  const std::lock_guard guard(making_);
  const std::uint64_t detection = live().detection_number();
  if (detection == 0 || detection != explained_.detection) {
    live::Live::Written written = live().write_detection();
    auto made = std::make_shared<Session>(open_(written.since));
    static_cast<void>(made->start_to_explain());
    show(std::move(made));
    explained_ = std::move(written);
  }
  return {
      {"saved", explained_.since}, {"before", explained_.before}, {"session", session_number()}};
}

nlohmann::ordered_json Stage::use_files(bool replace) {
  const std::lock_guard guard(making_);
  const SessionFiles files = intake().files();
  check_nothing_is_lost(replace);
  try {
    auto made = std::make_shared<Session>(open_files_(files));
    std::vector<std::string> written = intake().write(files);
    show(std::move(made));
    return {{"written", std::move(written)}};
  } catch (const InputError& error) {
    throw intake().folder().shown(error);
  }
}

ResultsView& Stage::results() const {
  if (results_) return *results_;
  throw Refused(Refused::Why::kNotNow,
                "This session is over no results: start Studio with --campaign or --benchmark.");
}

nlohmann::ordered_json Stage::open_run(std::int64_t run, bool replace) {
  const std::lock_guard guard(making_);
  ResultsView& view = results();
  check_nothing_is_lost(replace);
  try {
    const SessionFiles files = view.record(run);
    show(std::make_shared<Session>(open_files_(files)));
  } catch (const InputError& error) {
    throw view.shown(error);
  }
  return {{"run", run}};
}

void Stage::check_nothing_is_lost(bool replace) const {
  if (replace || !is_loaded() || !session()->has_steps()) return;
  throw Refused(Refused::Why::kMustConfirm,
                "The session begins anew: what was added and is not saved is lost.");
}

void Stage::show(std::shared_ptr<Session> made) {
  std::shared_ptr<Session> before;
  {
    const std::lock_guard shown(lock_);
    before = std::exchange(session_, std::move(made));
    ++shown_;
  }
  if (before) before->leave();
}

void Stage::leave() const {
  const std::lock_guard guard(lock_);
  if (session_) session_->leave();
}

}  // namespace offnominal::desk::studio
