#include <algorithm>
#include <chrono>
#include <exception>
#include <thread>

#include "live/controller_words.hpp"
#include "live/feed.hpp"
#include "loop/controller_settings.hpp"
#include "sil/both_ends.hpp"
#include "sil/plant_of.hpp"

namespace offnominal::desk::live {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kNap{4};
// What it is behind its time by more than that is left out: a machine that is too slow shows less,
// not later and later.
constexpr std::int64_t kMostBehindTicks = 100;

// One run from its start on, with the wire that it is on.
struct Run {
  Run(const RobotDescription& robot, const sil::Scenario& scenario,
      const TappedPort::OnFrame& on_frame)
      : wire(sil::make_in_process_wire()), ends(robot, scenario, *wire, on_frame) {}
  std::unique_ptr<sil::Wire> wire;
  sil::BothEnds ends;
};

class BenchOfRobot final : public Bench {
 public:
  BenchOfRobot(const RobotDescription& robot, const sil::Scenario& scenario, Pace pace)
      : robot_(robot),
        scenario_(scenario),
        pace_(pace),
        period_us_(period_us_of(robot.estimator.period_s)),
        run_(make_run()) {}

  void take(const OnFrame& on_frame) override {
    if (pace_ == Pace::kRealTime || !ended_.empty()) std::this_thread::sleep_for(kNap);
    if (!ended_.empty()) return;
    on_frame_ = &on_frame;
    try {
      if (!started_) start();
      for (std::int64_t due = ticks_due(); due > 0 && ended_.empty(); --due) tick();
    } catch (const std::exception& error) {
      ended_ = error.what();
    }
    on_frame_ = nullptr;
  }
  [[nodiscard]] hal::Microseconds now_us() const override { return base_us_ + run_->ends.now_us(); }
  [[nodiscard]] std::string ended() const override { return ended_; }
  [[nodiscard]] std::string remark() const override {
    constexpr std::chrono::seconds kShown{5};
    const bool is_late = left_out_at_ && Clock::now() - *left_out_at_ < kShown;
    return is_late ? "This machine is too slow for real time: the run goes slower." : "";
  }

  void set_faults(const std::vector<sim::FaultEvent>& faults) override {
    std::vector<sim::FaultEvent> all = scenario_.faults;
    const double now_s = run_->ends.plant().time_s();
    for (sim::FaultEvent fault : faults) {
      // One that goes on keeps its beginning.
      const auto same = std::find_if(injected_.begin(), injected_.end(), [&](const auto& other) {
        return other.kind == fault.kind && other.joint == fault.joint && other.size == fault.size;
      });
      fault.begin_s = same == injected_.end() ? now_s : same->begin_s;
      all.push_back(fault);
    }
    // Plants of robot files and of MuJoCo take any.
    static_cast<void>(run_->ends.set_faults(all));
    injected_.assign(all.begin() + static_cast<std::ptrdiff_t>(scenario_.faults.size()), all.end());
  }

  void set_accommodation(bool on) override {
    scenario_.accommodate = on;
    run_->ends.controller().set_accommodation(on);
  }

  // A plant of MuJoCo is read again, and its file may have changed or gone meanwhile.
  void begin_again() override {
    std::unique_ptr<Run> again;
    try {
      sil::check_scenario(robot_, scenario_);
      again = make_run();
    } catch (const std::exception& error) {
      ended_ = error.what();
      return;
    }
    base_us_ = now_us();
    injected_.clear();
    ended_.clear();
    safe_since_us_.reset();
    started_ = false;
    run_ = std::move(again);
  }

  [[nodiscard]] ControllerWord controller() const override {
    const auto& controller = run_->ends.controller();
    return {controller.state(), controller.fault(), controller.view().slows};
  }

 private:
  std::unique_ptr<Run> make_run() {
    return std::make_unique<Run>(robot_, scenario_,
                                 [this](const hal::Frame& frame, hal::Microseconds time_us) {
                                   if (on_frame_ != nullptr) {
                                     (*on_frame_)({frame, base_us_ + time_us});
                                   }
                                 });
  }

  void start() {
    started_ = true;
    run_->ends.start();
    begin_ = Clock::now();
    ticks_ = 0;
  }

  std::int64_t ticks_due() {
    if (pace_ == Pace::kAtSpeed) return kMostBehindTicks;
    const auto since = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begin_);
    const std::int64_t due = since.count() / period_us_ - ticks_;
    if (due <= kMostBehindTicks) return due;
    ticks_ += due - kMostBehindTicks;
    left_out_at_ = Clock::now();
    return kMostBehindTicks;
  }

  // Where no drive gives a torque any more the arm falls, and there is nothing to see.
  void tick() {
    constexpr hal::Microseconds kAfterwardsUs = 2'500'000;
    run_->ends.tick();
    ++ticks_;
    if (!run_->ends.is_safe()) return;
    if (!safe_since_us_) safe_since_us_ = now_us();
    if (now_us() < *safe_since_us_ + kAfterwardsUs) return;
    const controller::Fault fault = run_->ends.controller().fault();
    ended_ = std::string("The controller went to its safe state: ") + controller::name_of(fault) +
             ", " + words_of(fault) + ".";
  }

  RobotDescription robot_;
  sil::Scenario scenario_;
  Pace pace_;
  hal::Microseconds period_us_;
  const OnFrame* on_frame_ = nullptr;
  hal::Microseconds base_us_ = 0;
  std::unique_ptr<Run> run_;
  std::vector<sim::FaultEvent> injected_;
  std::string ended_;
  std::optional<hal::Microseconds> safe_since_us_;
  bool started_ = false;
  Clock::time_point begin_;
  std::int64_t ticks_ = 0;
  std::optional<Clock::time_point> left_out_at_;
};

}  // namespace

std::unique_ptr<Bench> make_bench(const RobotDescription& robot, const sil::Scenario& scenario,
                                  Pace pace) {
  sil::check_scenario(robot, scenario);
  return std::make_unique<BenchOfRobot>(robot, scenario, pace);
}

}  // namespace offnominal::desk::live
