#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "command/progress.hpp"
#include "log/log.hpp"
#include "log/read_log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// One recording: read_log, or read_log_or_hold_map where hold maps will do as well.
using ReadOne = Log(const std::filesystem::path& path, const RobotDescription& robot,
                    const ChannelOptions& channels);

// Every file as `read_one` reads it, each announced to `progress`.
std::vector<Log> read_recordings(const std::vector<std::string>& files,
                                 const RobotDescription& robot, const ChannelOptions& channels,
                                 ReadOne* read_one, Progress& progress);

// The payloads that --payload says. Throws InputError, in the name of `verb`, for what is none.
std::vector<RecordingPayload> payloads_of(const std::string& verb,
                                          const std::vector<std::string>& texts);

// Throws InputError, in the name of `verb`, where --payload speaks of a recording that is not
// given.
void check_payloads(const std::string& verb, const ChannelOptions& channels,
                    const std::vector<std::string>& files);

// Throws InputError, in the name of `verb`, where a recording is given twice under `option`: as the
// same file by whatever name, or, once they are read, as a copy of it.
void check_all_differ(const std::string& verb, const std::string& option,
                      const std::vector<std::string>& files);
void check_all_differ(const std::string& verb, const std::string& option,
                      const std::vector<Log>& logs);

// What a verb is given that fits to recordings and judges the fit on others.
struct FitFiles {
  std::string robot;
  std::vector<std::string> logs;
  std::vector<std::string> holdout;
  ChannelOptions channels;
  bool observe_velocity = false;  // --observe-velocity, of verbs that have it
};
struct FitData {
  RobotDescription robot;
  std::vector<Log> logs;
  std::vector<Log> holdout;
};

// Reads it. Throws InputError, in the name of `verb`, where a recording is there twice: as the same
// file by whatever name, or as a copy of it. What is fitted must not judge the fit. `option`: of
// the logs.
FitData read_fit_data(const std::string& verb, const std::string& option, const FitFiles& files,
                      ReadOne* read_one, Progress& progress);
// The same of a robot that was read already.
FitData read_fit_data(const std::string& verb, const std::string& option, const FitFiles& files,
                      RobotDescription robot, ReadOne* read_one, Progress& progress);

// Where --observe-velocity is given: every recording as a controller judges it that observes its
// velocities (observed_motion.hpp). Parts that are too short to settle in are left out where others
// are not.
void observe_velocities(const FitFiles& files, FitData& data);

// "a.csv, b.csv", "standard input": as input_name() has them, for a robot file's word on its
// source.
std::string file_names(const std::vector<std::string>& files);

}  // namespace offnominal::desk
