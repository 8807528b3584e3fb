#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace offnominal::desk::sil {

/// Another program that runs beside this one. What it prints goes to files.
class ChildProgram {
 public:
  /// `name` lies in the folder of this program. Throws InputError where it does not.
  ChildProgram(const std::string& name, std::vector<std::string> arguments,
               const std::filesystem::path& out, const std::filesystem::path& err);
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;
  ChildProgram(ChildProgram&&) = delete;
  ChildProgram& operator=(ChildProgram&&) = delete;
  /// Ends it by SIGKILL where it still runs.
  ~ChildProgram();

  /// Its exit code, or 128 + n where signal n ended it; none while it runs.
  [[nodiscard]] std::optional<int> exit_code();
  void send(int signal) const;
  /// Waits for its end; sends SIGTERM first, where told to, and SIGKILL when patience_s is over.
  int wait(bool terminate, double patience_s);

 private:
  pid_t pid_ = 0;
  std::optional<int> exit_code_;
};

}  // namespace offnominal::desk::sil
