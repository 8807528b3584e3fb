#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "desk/support/temporary_folder.hpp"

namespace offnominal::test {

struct CommandResult {
  int exit_code = -1;  // 128 + n: ended by signal n
  std::string out;
  std::string err;
};

/// Runs a program without a shell. `out_to` names the file that takes its standard output, in place
/// of the result's `out`; `in_from` that of its standard input.
inline CommandResult run_command(const std::string& program, std::vector<std::string> arguments,
                                 const std::string& out_to = {},
                                 const std::string& in_from = "/dev/null") {
  const TemporaryFolder folder;
  const std::string out = out_to.empty() ? (folder / "out").string() : out_to;
  const std::string err = (folder / "err").string();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const int write_flags = O_WRONLY | O_CREAT;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, in_from.c_str(), O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), write_flags, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), write_flags, 0600);
  arguments.insert(arguments.begin(), program);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  const int error =
      ::posix_spawn(&child, program.c_str(), &actions, nullptr, argv.data(), ::environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error(program + ": " + std::strerror(error));
  int status = 0;
  if (::waitpid(child, &status, 0) != child) throw std::runtime_error("waitpid failed");
  CommandResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (out_to.empty()) result.out = content_of(out);
  result.err = content_of(err);
  return result;
}

}  // namespace offnominal::test
