#include "sil/child_program.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include "common/error.hpp"

namespace offnominal::desk::sil {
namespace {

std::filesystem::path beside_this_program(const std::string& name) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  std::filesystem::path program = self.parent_path() / name;
  if (!error && ::access(program.c_str(), X_OK) == 0) return program;
  throw InputError({program.string(), "", error ? error.message() : std::strerror(errno),
                    "the program, beside the one that starts it", "build or install both"});
}

}  // namespace

ChildProgram::ChildProgram(const std::string& name, std::vector<std::string> arguments,
                           const std::filesystem::path& out, const std::filesystem::path& err) {
  const std::string program = beside_this_program(name).string();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  constexpr int kWrite = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), kWrite, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), kWrite, 0600);
  arguments.insert(arguments.begin(), program);
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const int error =
      ::posix_spawn(&pid_, program.c_str(), &actions, nullptr, argv.data(), ::environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw InputError({program, "", std::strerror(error), "a program", ""});
}

ChildProgram::~ChildProgram() {
  if (!exit_code_) wait(false, 0);
}

std::optional<int> ChildProgram::exit_code() {
  int status = 0;
  if (!exit_code_ && ::waitpid(pid_, &status, WNOHANG) == pid_) {
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  return exit_code_;
}

void ChildProgram::send(int signal) const {
  if (!exit_code_) ::kill(pid_, signal);
}

int ChildProgram::wait(bool terminate, double patience_s) {
  using Clock = std::chrono::steady_clock;
  if (terminate) send(SIGTERM);
  const auto end = Clock::now() + std::chrono::duration<double>(patience_s);
  while (!exit_code()) {
    if (Clock::now() >= end) send(SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds{5});
  }
  return *exit_code_;
}

}  // namespace offnominal::desk::sil
