#include "studio/job.hpp"

#include <utility>

namespace offnominal::desk::studio {
namespace {

// Thrown through explain() from its word of progress.
struct Stopped {};

}  // namespace

Job::~Job() {
  stop();
  if (thread_.joinable()) thread_.join();
}

bool Job::is_running() const {
  const std::lock_guard guard(lock_);
  return report_.state == State::kRunning;
}

Job::Report Job::report() {
  const std::lock_guard guard(lock_);
  asked_ = Clock::now();
  if (report_.state == State::kRunning) {
    report_.seconds = std::chrono::duration<double>(asked_ - start_).count();
    if (stopped_) report_.doing = "stopping at the end of this part";
  }
  return report_;
}

void Job::start(RobotDescription robot, std::shared_ptr<const Treated> recordings,
                ExplainOptions options, std::size_t revision) {
  if (thread_.joinable()) thread_.join();
  stopped_ = false;
  {
    const std::lock_guard guard(lock_);
    report_ = Report{};
    report_.state = State::kRunning;
    report_.doing = "starting";
    report_.of_revision = revision;
    start_ = asked_ = Clock::now();
  }
  thread_ = std::thread([this, robot = std::move(robot), recordings = std::move(recordings),
                         options = std::move(options)] { run(robot, *recordings, options); });
}

void Job::tell(const std::string& doing) {
  const std::lock_guard guard(lock_);
  if (stopped_ || Clock::now() - asked_ > kAbandoned) throw Stopped{};
  report_.doing = doing;
}

void Job::run(const RobotDescription& robot, const Treated& recordings,
              const ExplainOptions& options) {
  Report end;
  try {
    end.explanation = std::make_shared<const Explanation>(
        explain(robot, recordings, options, [this](const std::string& doing) { tell(doing); }));
    end.state = State::kDone;
  } catch (const Stopped&) {
    end.state = State::kStopped;
  } catch (const std::exception& error) {
    end.state = State::kFailed;
    end.error = error.what();
  }
  const std::lock_guard guard(lock_);
  end.seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  end.of_revision = report_.of_revision;
  report_ = std::move(end);
}

}  // namespace offnominal::desk::studio
