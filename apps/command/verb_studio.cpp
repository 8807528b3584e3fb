#include <fcntl.h>
#include <pthread.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "command/doctor.hpp"
#include "command/input_options.hpp"
#include "command/progress.hpp"
#include "command/recordings.hpp"
#include "command/refuse_option.hpp"
#include "command/verbs.hpp"
#include "common/input_name.hpp"
#include "common/json_text.hpp"
#include "common/output_file.hpp"
#include "common/shell_word.hpp"
#include "log/log_format.hpp"
#include "log/read_log.hpp"
#include "log/seen_by_sensor.hpp"
#include "studio/server.hpp"

namespace offnominal::desk {
namespace {

struct StudioOptions {
  FitFiles files;
  std::vector<KeepFault> keep;
  std::optional<std::string> output;
  int port = 0;
  bool no_open = false;
  bool json = false;
  bool force = false;
  int threads = 1;
};

// Of what was given, that which every command has to be given again to read the same; beside
// --payload, which is of a recording.
std::string options_of(const CLI::App& verb) {
  std::string line;
  for (const char* name : {"--channels", "--period", "--keep"}) {
    const CLI::Option* option = verb.get_option(name);
    for (const std::string& word : option->results()) {
      line += std::string(" ") + name + " " + shell_word(word);
    }
  }
  return line;
}

studio::Input read_input(const StudioOptions& options, const std::string& more) {
  const FitFiles& files = options.files;
  for (const auto* some : {&files.logs, &files.holdout}) {
    for (const std::string& file : *some) {
      if (is_stream(file)) {
        refuse_option("studio", "RECORDING", input_name(file), "files",
                      "the commands that repeat the session read them again");
      }
    }
  }
  Progress progress;
  FitData data = read_fit_data("studio", "RECORDING", files, read_log, progress);
  for (const std::vector<Log>* some : {&data.logs, &data.holdout}) {
    for (const Log& log : *some) refuse_hidden_from_sensors(data.robot, log);
  }
  Treated recordings;
  recordings.faults =
      treated({data.logs, data.holdout}, data.robot, options.keep, progress, RestsOn::kTorque);
  recordings.logs = std::move(data.logs);
  recordings.holdout = std::move(data.holdout);
  studio::Input input;
  input.robot = std::move(data.robot);
  input.robot_file = files.robot;
  input.recordings = std::make_shared<const Treated>(std::move(recordings));
  input.log_files = files.logs;
  input.holdout_files = files.holdout;
  input.source = "Fitted to " + file_names(files.logs) + " by offnominal add.";
  input.options = more;
  input.payloads = files.channels.payloads;
  input.output = options.output;
  input.threads = options.threads;
  return input;
}

// Best effort: the address is printed all the same.
void open_browser(const std::string& address) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  std::string program = "xdg-open";
  std::string argument = address;
  std::array<char*, 3> words = {program.data(), argument.data(), nullptr};
  posix_spawn_file_actions_t silent;
  posix_spawn_file_actions_init(&silent);
  posix_spawn_file_actions_addopen(&silent, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&silent, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&silent, 2, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  // A session of its own: Ctrl-C in the terminal is not for the browser.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSID);
  pid_t child = 0;
  if (posix_spawnp(&child, words[0], &silent, &attributes, words.data(), environ) == 0) {
    std::thread([child] { ::waitpid(child, nullptr, 0); }).detach();
  }
  posix_spawn_file_actions_destroy(&silent);
  posix_spawnattr_destroy(&attributes);
}

// Ctrl-C and a request to end, waited for by a thread of their own: a handler may do next to
// nothing.
class EndOnSignal {
 public:
  explicit EndOnSignal(studio::Server& server) : server_(server) {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    sigaddset(&signals_, SIGHUP);
    pthread_sigmask(SIG_BLOCK, &signals_, &before_);
  }
  EndOnSignal(const EndOnSignal&) = delete;
  EndOnSignal& operator=(const EndOnSignal&) = delete;
  ~EndOnSignal() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }

  void watch() {
    thread_ = std::thread([this] {
      constexpr timespec kQuarter = {0, 250'000'000};
      while (!over_) {
        if (sigtimedwait(&signals_, nullptr, &kQuarter) < 0) continue;
        server_.stop();
        return;
      }
    });
  }

 private:
  studio::Server& server_;
  sigset_t signals_{};
  sigset_t before_{};
  std::atomic<bool> over_ = false;
  std::thread thread_;
};

void run(const StudioOptions& options, const std::string& more) {
  studio::Server server(read_input(options, more), options.port);
  EndOnSignal end(server);
  if (options.json) {
    std::cout << json_text(
        nlohmann::ordered_json{{"address", server.address()}, {"port", server.port()}});
  } else {
    std::cout << "Studio is at " << server.address() << "\nCtrl-C ends it.\n";
  }
  std::cout.flush();
  end.watch();
  if (!options.no_open) open_browser(server.address());
  server.run();
}

}  // namespace

void set_up_studio(CLI::App& verb, ExitCode& /*exit_code*/) {
  const auto options = std::make_shared<StudioOptions>();
  verb.add_option("RECORDING", options->files.logs,
                  "One recording to fit or several, " + log_format_names())
      ->required();
  verb.add_option("--robot", options->files.robot, "Robot file to start from")->required();
  verb.add_option("--holdout", options->files.holdout,
                  "Recordings to judge the fit on: no fit sees them. Without any, parts of the "
                  "others are held out");
  verb.add_option("-o,--output", options->output,
                  "Robot file that saving writes, and no other [one beside the robot file, under a "
                  "name that the page asks for]")
      ->type_name(kNewRobotFile);
  verb.add_flag("--force", options->force,
                "-o may name a file that is there; the page still asks before it replaces it");
  verb.add_option("--port", options->port, "Port of 127.0.0.1 [a free one]")
      ->check(CLI::Range(1, 65535));
  verb.add_flag("--no-open", options->no_open, "Print the address and open no browser");
  add_channels_option(verb, options->files.channels, "recordings'");
  add_keep_option(verb, options->keep);
  add_threads_option(verb, options->threads, "Threads of the search for missing effects");
  verb.add_flag("--json", options->json, "Print the address as one JSON object and nothing else");
  verb.footer(
      "One page on this machine: look at the error of every joint, let `explain` say what is "
      "missing, switch effects on and off and watch the error on held-out data, save the robot "
      "file. The numbers are those of `add`, `compare` and `explain`. Nothing leaves the machine; "
      "the address holds a token that nobody can guess, and is all that lets one in.");
  verb.callback([&verb, options] { run(*options, options_of(verb)); });
}

}  // namespace offnominal::desk
