#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "command/progress.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::tools {

// Every file as read_log reads it, each announced to `progress`.
std::vector<Log> read_recordings(const std::vector<std::string>& files,
                                 const RobotDescription& robot,
                                 const std::optional<std::filesystem::path>& channels,
                                 Progress& progress);

// The same where hold maps will do as well, as read_log_or_hold_map reads them.
std::vector<Log> read_recordings_or_hold_maps(const std::vector<std::string>& files,
                                              const RobotDescription& robot,
                                              const std::optional<std::filesystem::path>& channels,
                                              Progress& progress);

// Throws InputError, in the name of `verb`, where a recording is there twice: as the same file by
// whatever name, or as a copy of it. What is fitted must not judge the fit. `option`: of the logs.
void check_recordings_differ(const std::string& verb, const std::string& option,
                             const std::vector<std::string>& logs,
                             const std::vector<std::string>& holdout);
void check_recordings_differ(const std::string& verb, const std::string& option,
                             const std::vector<Log>& logs, const std::vector<Log>& holdout);

// "a.csv, b.csv", "standard input": as input_name() has them, for a robot file's word on its
// source.
std::string file_names(const std::vector<std::string>& files);

}  // namespace offnominal::tools
