#include "studio/commands.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "common/shell_word.hpp"

namespace offnominal::desk::studio {
namespace {

// "found_1.toml", beside "found.toml".
std::string file_after(std::size_t steps, std::size_t count, const std::string& output) {
  if (steps == count) return output;
  std::filesystem::path path(output);
  path.replace_filename(
      fmt::format("{}_{}{}", path.stem().string(), steps, path.extension().string()));
  return path.string();
}

}  // namespace

std::vector<std::string> commands_of(const Workbench& bench, const std::string& output) {
  const Input& input = bench.input();
  const std::size_t count = bench.steps().size();
  std::vector<std::string> commands;
  std::string robot = input.robot_file;
  for (std::size_t i = 0; i < count; ++i) {
    const Step& step = bench.steps()[i];
    const std::string file = file_after(i + 1, count, output);
    std::string line =
        fmt::format("offnominal add {} --joint {} --robot {} --log {}", info_of(step.kind)->name,
                    step.joint + 1, shell_word(robot), shell_words(input.log_files));
    if (!input.holdout_files.empty()) line += " --holdout " + shell_words(input.holdout_files);
    line += " -o " + shell_word(file) + input.options;
    if (!bench.fitted(i).result.doubts.empty()) line += " --force";
    commands.push_back(std::move(line));
    robot = file;
  }
  if (count > 0) {
    commands.push_back(fmt::format("offnominal compare {} --robot {}{}",
                                   shell_words(input.log_files), shell_word(output),
                                   input.options));
  }
  return commands;
}

}  // namespace offnominal::desk::studio
