#include "qemu.hpp"

#include <filesystem>
#include <stdexcept>

#include "desk/support/run_command.hpp"
#include "support/places.hpp"

namespace offnominal::test {

int run_on(const Board& board, const std::string& program,
           const std::vector<std::string>& arguments) {
  const std::string image =
      (source_dir() / "build" / board.preset / "targets/cortex_m" / (program + ".elf")).string();
  if (!std::filesystem::exists(image)) {
    throw std::runtime_error(image + " is not there: ./dev firmware builds it");
  }
  std::string semihosting = "enable=on,target=native,arg=" + program;
  for (const std::string& argument : arguments) semihosting += ",arg=" + argument;
  // env looks along the PATH.
  const CommandResult result = run_command(
      "/usr/bin/env", {"timeout", "300", "qemu-system-arm", "-M", board.machine, "-nographic",
                       "-semihosting-config", semihosting, "-kernel", image});
  constexpr int kNotFound = 127;
  if (result.exit_code == kNotFound) {
    throw std::runtime_error("qemu-system-arm did not run: ./dev setup installs it");
  }
  return result.exit_code;
}

}  // namespace offnominal::test
