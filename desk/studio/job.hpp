#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "explain/explain.hpp"
#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

/// `explain` in the background: one at a time. It works on copies; what it says is under one lock.
/// It stops at its next word of progress after stop(), and where nobody has asked for its state for
/// kAbandoned: the page is gone.
class Job {
 public:
  enum class State { kNone, kRunning, kDone, kStopped, kFailed };
  struct Report {
    State state = State::kNone;
    std::string doing;  // while it runs
    double seconds = 0;
    std::string error;                                         // where it failed
    std::shared_ptr<const Explanation> explanation = nullptr;  // where it is done
    std::size_t of_revision = 0;                               // as start() was given it
  };
  /// A page that is hidden behind others asks once a minute.
  static constexpr std::chrono::seconds kAbandoned{90};

  Job() = default;
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;
  /// Stops it and waits for it.
  ~Job();

  /// Starts to explain what `robot` lacks; `revision` comes back with the answer. Must not be
  /// called while it runs. `recordings` are never changed.
  void start(RobotDescription robot, std::shared_ptr<const Treated> recordings,
             ExplainOptions options, std::size_t revision);
  /// Returns at once.
  void stop() { stopped_ = true; }
  [[nodiscard]] bool is_running() const;
  /// Says that somebody is there.
  [[nodiscard]] Report report();

 private:
  using Clock = std::chrono::steady_clock;
  void run(const RobotDescription& robot, const Treated& recordings, const ExplainOptions& options);
  void tell(const std::string& doing);

  mutable std::mutex lock_;  // of report_, start_ and asked_
  Report report_;
  Clock::time_point start_;
  Clock::time_point asked_;
  std::atomic<bool> stopped_ = false;
  std::thread thread_;
};

}  // namespace offnominal::desk::studio
