#include "qemu.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>

namespace offnominal::test {

int run_on(const Board& board, const std::string& program,
           const std::vector<std::string>& arguments) {
  const std::string image =
      std::string(OFFNOMINAL_BUILDS) + "/" + board.preset + "/targets/cortex_m/" + program + ".elf";
  if (!std::filesystem::exists(image)) {
    throw std::runtime_error(image + " is not there: ./dev firmware builds it");
  }
  std::string semihosting = "enable=on,target=native,arg=" + program;
  for (const std::string& argument : arguments) semihosting += ",arg=" + argument;
  const std::string command = std::string("timeout 300 qemu-system-arm -M ") + board.machine +
                              " -nographic -semihosting-config '" + semihosting + "' -kernel '" +
                              image + "' </dev/null";
  const int status = std::system(command.c_str());
  constexpr int kNotFound = 127;
  if (!WIFEXITED(status) || WEXITSTATUS(status) == kNotFound) {
    throw std::runtime_error("qemu-system-arm did not run: ./dev setup installs it");
  }
  return WEXITSTATUS(status);
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern =
      (std::filesystem::temp_directory_path() / "offnominal-firmware-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace offnominal::test
