#include "wcet/cyclictest.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/error.hpp"
#include "common/file.hpp"

namespace offnominal::desk::wcet {
namespace {

// A file of its own for the answer, removed at the end.
class AnswerFile {
 public:
  AnswerFile() : name_(std::filesystem::temp_directory_path() / "offnominal-cyclictest-XXXXXX") {
    const int file = ::mkstemp(name_.data());
    if (file < 0) throw std::runtime_error("no temporary file can be made: " + name_);
    ::close(file);
  }
  AnswerFile(const AnswerFile&) = delete;
  AnswerFile& operator=(const AnswerFile&) = delete;
  ~AnswerFile() { ::unlink(name_.c_str()); }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
};

[[noreturn]] void refuse(const std::string& found, const std::string& mend) {
  throw InputError({.file = "offnominal-wcet",
                    .place = "--compare-cyclictest",
                    .found = found,
                    .allowed = "",
                    .mend = mend});
}

// Exit code of the program, found along PATH; its output goes nowhere.
int run(std::vector<std::string> words) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
    ::posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
  }
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), ::environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT) refuse("no cyclictest on this machine", "install the package rt-tests");
  if (error != 0) refuse("that cyclictest cannot be started", "run it by hand");
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

}  // namespace

double CyclictestResult::quantile_us(double p) const {
  const auto needed = static_cast<std::int64_t>(std::ceil(p * static_cast<double>(cycles)));
  std::int64_t below = 0;
  for (const auto& [latency_us, count] : histogram) {
    below += count;
    if (below >= std::max<std::int64_t>(needed, 1)) return static_cast<double>(latency_us);
  }
  return max_us;
}

std::vector<std::string> cyclictest_arguments(const CyclicSettings& settings,
                                              const std::string& json_file) {
  std::vector<std::string> words{"cyclictest", "--quiet", "--threads=1",
                                 "--interval=" + std::to_string(settings.interval_us),
                                 "--loops=" + std::to_string(settings.ticks),
                                 "--histogram=" + std::to_string(kCyclictestHistogramUs),
                                 // No power management that the tick did not have either.
                                 "--default-system", "--json=" + json_file};
  const bool real_time = settings.machine.scheduler.starts_with("SCHED_FIFO");
  words.emplace_back(real_time ? "--policy=fifo" : "--policy=other");
  if (real_time) {
    words.push_back("--priority=" + std::to_string(settings.request.priority.value_or(1)));
  }
  if (settings.machine.cpu) words.push_back("--affinity=" + std::to_string(*settings.machine.cpu));
  if (settings.machine.memory_locked) words.emplace_back("--mlockall");
  return words;
}

CyclictestResult parse_cyclictest(std::string_view json_text) {
  try {
    const auto json = nlohmann::json::parse(json_text);
    const auto& thread = json.at("thread").at("0");
    CyclictestResult result;
    // The key is written with a colon in it.
    result.version = json.value("rt_test_version:", "");
    result.cycles = thread.at("cycles").get<std::int64_t>();
    result.min_us = thread.at("min").get<double>();
    result.mean_us = thread.at("avg").get<double>();
    result.max_us = thread.at("max").get<double>();
    for (const auto& [latency, count] : thread.at("histogram").items()) {
      result.histogram.emplace_back(std::stoll(latency), count.get<std::int64_t>());
    }
    std::sort(result.histogram.begin(), result.histogram.end());
    return result;
  } catch (const std::exception& error) {
    throw std::runtime_error(std::string("not an answer of cyclictest: ") + error.what());
  }
}

CyclictestResult run_cyclictest(const CyclicSettings& settings) {
  const AnswerFile answer;
  const std::vector<std::string> words = cyclictest_arguments(settings, answer.name());
  const int exit_code = run(words);
  std::string command;
  for (const std::string& word : words) {
    if (!word.starts_with("--json")) command += (command.empty() ? "" : " ") + word;
  }
  if (exit_code != 0) {
    refuse("that it ended with " + std::to_string(exit_code), "run it by hand: " + command);
  }
  CyclictestResult result = parse_cyclictest(read_text_file(answer.name()));
  result.command = command;
  return result;
}

}  // namespace offnominal::desk::wcet
