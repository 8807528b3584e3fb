#include "studio/commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "common/shell_word.hpp"
#include "robot/payload.hpp"

namespace offnominal::desk::studio {
namespace {

// A robot file that is read, a recording, or anything else that a command must not write over.
bool is_there(const std::string& file) {
  std::error_code ignored;
  return std::filesystem::exists(std::filesystem::symlink_status(file, ignored));
}

// "found_1.toml", beside "found.toml"; where that is there already, "found_1_2.toml" and so on.
std::string free_name(const std::string& output, const std::string& ending) {
  const std::filesystem::path beside(output);
  std::filesystem::path path;
  for (int number = 1; number == 1 || is_there(path.string()); ++number) {
    const std::string again = number == 1 ? "" : fmt::format("_{}", number);
    path = beside;
    path.replace_filename(fmt::format("{}_{}{}{}", beside.stem().string(), ending, again,
                                      beside.extension().string()));
  }
  return path.string();
}

std::string file_after(std::size_t steps, std::size_t count, const std::string& output) {
  if (steps < count) return free_name(output, fmt::format("{}", steps));
  return is_there(output) ? free_name(output, "again") : output;
}

// What --payload says of some files: a command takes none of a recording that it does not read.
std::string payloads_of(const Input& input, const std::vector<std::string>& files) {
  std::string words;
  for (const RecordingPayload& payload : input.payloads) {
    const auto speaks_of = [&](const std::string& file) { return is_of(payload, file); };
    if (std::none_of(files.begin(), files.end(), speaks_of)) continue;
    words += " --payload " + shell_word(text_of(payload));
  }
  return words;
}

}  // namespace

std::vector<std::string> commands_of(const Workbench& bench, const std::string& output) {
  const Input& input = bench.input();
  const std::size_t count = bench.steps().size();
  std::vector<std::string> all_files = input.log_files;
  all_files.insert(all_files.end(), input.holdout_files.begin(), input.holdout_files.end());
  const std::string more = input.options + payloads_of(input, all_files);
  std::vector<std::string> commands;
  if (count > 0) commands = input.commands_before;
  std::string robot = input.robot_file;
  for (std::size_t i = 0; i < count; ++i) {
    const Step& step = bench.steps()[i];
    const std::string file = file_after(i + 1, count, output);
    std::string line =
        fmt::format("offnominal add {} --joint {} --robot {} --log {}", info_of(step.kind)->name,
                    step.joint + 1, shell_word(robot), shell_words(input.log_files));
    if (!input.holdout_files.empty()) line += " --holdout " + shell_words(input.holdout_files);
    line += " -o " + shell_word(file) + more;
    if (!bench.fitted(i).result.doubts.empty()) line += " --force";
    commands.push_back(std::move(line));
    robot = file;
  }
  if (count > 0) {
    commands.push_back(fmt::format("offnominal compare {} --robot {}{}{}",
                                   shell_words(input.log_files), shell_word(robot), input.options,
                                   payloads_of(input, input.log_files)));
  }
  return commands;
}

std::vector<std::string> commands_at_rest(const SessionFiles& files) {
  const auto names_of = [](const std::vector<NamedFile>& some) {
    std::vector<std::string> names;
    for (const NamedFile& file : some) names.push_back(file.name);
    return names;
  };
  std::string more;
  if (!files.holdout.empty()) more += " --holdout " + shell_words(names_of(files.holdout));
  if (files.channels) more += " --channels " + shell_word(files.channels->name);
  for (const RecordingPayload& payload : files.payloads) {
    more += " --payload " + shell_word(text_of(payload));
  }
  const std::string robot = shell_word(files.robot.name);
  const std::string logs = shell_words(names_of(files.logs));
  return {fmt::format("offnominal explain {} --robot {}{}", logs, robot, more),
          fmt::format("offnominal add --all-found --robot {} --log {}{} -o {}", robot, logs, more,
                      shell_word(free_name(files.robot.name, "found")))};
}

}  // namespace offnominal::desk::studio
