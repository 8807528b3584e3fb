// The controller's program on vcan0, and the arm at the other end, tick by tick in this process.
#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <offnominal/realtime/cycle_timer.hpp>
#include <offnominal/realtime/privileges.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "desk/support/temporary_folder.hpp"
#include "offnominal/sim/bus/plant_node.hpp"
#include "sil/plant_of.hpp"
#include "support/places.hpp"

namespace offnominal::desk::sil {

inline constexpr double kTickSeconds = 0.001;
inline constexpr hal::Microseconds kTickUs = 1000;

// offnominal-controller at 1000 ticks a second, armed by itself. What it says goes to files.
class ControllerProcess {
 public:
  explicit ControllerProcess(const std::vector<std::string>& more) {
    std::vector<std::string> words = {
        test::controller_file(), "--bus", "vcan0", "--arm", "--motion", "paper", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    constexpr int kNew = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out().c_str(), kNew, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err().c_str(), kNew, 0600);
    const int error = ::posix_spawn(&child_, argv[0], &actions, nullptr, argv.data(), ::environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) throw std::runtime_error(words[0]);
  }
  ControllerProcess(const ControllerProcess&) = delete;
  ControllerProcess& operator=(const ControllerProcess&) = delete;
  ControllerProcess(ControllerProcess&&) = delete;
  ControllerProcess& operator=(ControllerProcess&&) = delete;
  ~ControllerProcess() {
    if (child_ == 0) return;
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }

  void signal(int number) const { ::kill(child_, number); }
  [[nodiscard]] bool has_ended() const {
    siginfo_t ended{};
    ::waitid(P_PID, static_cast<id_t>(child_), &ended, WEXITED | WNOHANG | WNOWAIT);
    return ended.si_pid != 0;
  }
  // As waitpid() gives it.
  int wait() {
    int status = 0;
    if (::waitpid(child_, &status, 0) != child_) throw std::runtime_error("waitpid");
    child_ = 0;
    return status;
  }
  [[nodiscard]] std::string said() const { return test::content_of(err()); }
  [[nodiscard]] std::string printed() const { return test::content_of(out()); }

 private:
  [[nodiscard]] std::string out() const { return folder_ / "out"; }
  [[nodiscard]] std::string err() const { return folder_ / "err"; }

  test::TemporaryFolder folder_;
  pid_t child_ = 0;
};

// The paper's arm at its end of a bus, in real time.
template <hal::Bus Bus>
class Arm {
 public:
  explicit Arm(Bus& bus) : plant_(plant_of({}, {}, kTickSeconds)), bus_(bus) {
    static_cast<void>(realtime::ask_for({.priority = 80, .lock_memory = false}));
  }
  void tick() {
    const realtime::Tick begun = timer_.wait();
    plant_.tick(begun.begin_us + timer_.period_us(), bus_);
  }
  void ticks(int count) {
    for (; count > 0; --count) tick();
  }
  // Until done() says so, or a minute has passed; returns whether it did.
  template <typename Done>
  bool tick_until(const Done& done) {
    for (int i = 0; i < 60'000; ++i) {
      if (done()) return true;
      tick();
    }
    return false;
  }
  // Somebody brings it back to where its motion begins, and closes its brakes.
  void put_back() { plant_ = plant_of({}, {}, kTickSeconds); }
  [[nodiscard]] const sim::PlantNode& plant() const { return plant_; }
  [[nodiscard]] bool gives_torque() const { return plant_.drives().any_in_torque_mode(); }

 private:
  sim::PlantNode plant_;
  Bus& bus_;
  realtime::CycleTimer timer_{kTickUs, kTickUs / 2};
};

}  // namespace offnominal::desk::sil
