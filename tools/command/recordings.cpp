#include "command/recordings.hpp"

#include "log/read_log.hpp"

namespace offnominal::tools {

namespace {

template <typename Read>
std::vector<Log> read_each(const std::vector<std::string>& files, Progress& progress,
                           const Read& read) {
  std::vector<Log> logs;
  for (const std::string& file : files) {
    progress.begin("reading " + file);
    logs.push_back(read(file));
  }
  return logs;
}

}  // namespace

std::vector<Log> read_recordings(const std::vector<std::string>& files,
                                 const RobotDescription& robot,
                                 const std::optional<std::filesystem::path>& channels,
                                 Progress& progress) {
  return read_each(files, progress,
                   [&](const std::string& file) { return read_log(file, robot, channels); });
}

std::vector<Log> read_recordings_or_hold_maps(const std::vector<std::string>& files,
                                              const RobotDescription& robot,
                                              const std::optional<std::filesystem::path>& channels,
                                              Progress& progress) {
  return read_each(files, progress, [&](const std::string& file) {
    return read_log_or_hold_map(file, robot, channels);
  });
}

std::string file_names(const std::vector<std::string>& files) {
  std::string names;
  for (const std::string& file : files) {
    names += (names.empty() ? "" : ", ") + std::filesystem::path(file).filename().string();
  }
  return names;
}

}  // namespace offnominal::tools
