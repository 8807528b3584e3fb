#include "command/recordings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "command/read_robot.hpp"
#include "command/refuse_option.hpp"
#include "common/input_name.hpp"
#include "common/json_text.hpp"
#include "common/nearest.hpp"
#include "common/number.hpp"
#include "common/output_file.hpp"
#include "log/observed_motion.hpp"
#include "robot/payload.hpp"
#include "robot/payload_check.hpp"

namespace offnominal::desk {

namespace {

bool same_recording(const std::string& a, const std::string& b) { return same_file(a, b); }

// Another origin of time rounds anew what was written in digits, by less than half a period.
bool same_but_for_start(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  if (a.size() != b.size()) return false;
  if (a.size() < 2) return true;
  const Eigen::Index last = a.size() - 1;
  const double period = (a[last] - a[0]) / static_cast<double>(last);
  const auto moved = ((a.array() - a[0]) - (b.array() - b[0])).abs();
  return moved.maxCoeff() <= 0.5 * std::abs(period);
}

bool same_recording(const Log& a, const Log& b) {
  const auto same = [](const auto& x, const auto& y) {
    return x.rows() == y.rows() && x.cols() == y.cols() && (x.array() == y.array()).all();
  };
  return same(a.q, b.q) && same(a.tau, b.tau) && same_but_for_start(a.t_s, b.t_s);
}

const std::string& name_of(const std::string& file) { return file; }
const std::string& name_of(const Log& log) { return log.file; }

template <typename Recording>
void check_each_differs(const std::string& verb, const std::string& option,
                        const std::vector<Recording>& logs, const std::vector<Recording>& holdout) {
  std::vector<const Recording*> seen;
  const auto check = [&](const Recording& one, const std::string& of, const std::string& mend) {
    for (const Recording* other : seen) {
      if (!same_recording(one, *other)) continue;
      refuse_option(verb, of, name_of(one) + ", the same as " + name_of(*other),
                    "recordings that differ", mend);
    }
    seen.push_back(&one);
  };
  for (const Recording& log : logs) check(log, option, "leave one of the two out");
  for (const Recording& log : holdout) {
    check(log, "--holdout",
          "give a recording that is not fitted, or leave --holdout out: parts of the recordings "
          "are then held out");
  }
}

// What a payload lacks whose text is none.
std::string mend_of_payload_text(const std::string& text) {
  std::vector<std::string> lacks;
  const std::size_t at = text.rfind('@');
  const std::size_t equals = text.substr(0, at).rfind('=');
  if (equals == std::string::npos || equals == 0) {
    lacks.emplace_back("write the recording and = before the mass");
  }
  if (at == std::string::npos) {
    lacks.emplace_back("write @X,Y,Z behind the mass, its place in the last link's frame");
  } else if (std::count(text.begin() + static_cast<std::ptrdiff_t>(at), text.end(), ',') != 2) {
    lacks.emplace_back("write three numbers behind @, its place in the last link's frame");
  }
  if (!lacks.empty()) return fmt::format("{}", fmt::join(lacks, ", and "));
  return mend_of_payload() + " behind @";
}

}  // namespace

void check_all_differ(const std::string& verb, const std::string& option,
                      const std::vector<std::string>& files) {
  check_each_differs(verb, option, files, {});
}

void check_all_differ(const std::string& verb, const std::string& option,
                      const std::vector<Log>& logs) {
  check_each_differs(verb, option, logs, {});
}

std::vector<RecordingPayload> payloads_of(const std::string& verb,
                                          const std::vector<std::string>& texts) {
  std::vector<RecordingPayload> payloads;
  for (const std::string& text : texts) {
    const auto payload = payload_of_text(text);
    if (!payload) {
      refuse_option(
          verb, "--payload", "\"" + text + "\"",
          fmt::format("LOG=KG@X,Y,Z with {}, such as run_2.csv=0.8@0,0,0.1", kAllowedPayload),
          mend_of_payload_text(text));
    }
    payloads.push_back(*payload);
  }
  return payloads;
}

void check_payloads(const std::string& verb, const ChannelOptions& channels,
                    const std::vector<std::string>& files) {
  for (const RecordingPayload& payload : channels.payloads) {
    const auto speaks_of = [&](const std::string& file) { return is_of(payload, file); };
    if (std::any_of(files.begin(), files.end(), speaks_of)) continue;
    refuse_option(verb, "--payload", "a payload of " + payload.recording,
                  "one of the recordings: " + list_of(files),
                  "name the recording as it is given, or its file without the folder");
  }
}

std::vector<Log> read_recordings(const std::vector<std::string>& files,
                                 const RobotDescription& robot, const ChannelOptions& channels,
                                 ReadOne* read_one, Progress& progress) {
  std::vector<Log> logs;
  for (const std::string& file : files) {
    progress.begin("reading " + file);
    logs.push_back(read_one(file, robot, channels));
  }
  return logs;
}

FitData read_fit_data(const std::string& verb, const std::string& option, const FitFiles& files,
                      RobotDescription robot, ReadOne* read_one, Progress& progress) {
  check_each_differs(verb, option, files.logs, files.holdout);
  std::vector<std::string> all = files.logs;
  all.insert(all.end(), files.holdout.begin(), files.holdout.end());
  check_payloads(verb, files.channels, all);
  FitData data{std::move(robot), {}, {}};
  data.logs = read_recordings(files.logs, data.robot, files.channels, read_one, progress);
  data.holdout = read_recordings(files.holdout, data.robot, files.channels, read_one, progress);
  check_each_differs(verb, option, data.logs, data.holdout);
  return data;
}

FitData read_fit_data(const std::string& verb, const std::string& option, const FitFiles& files,
                      ReadOne* read_one, Progress& progress) {
  return read_fit_data(verb, option, files, read_robot(files.robot), read_one, progress);
}

void observe_velocities(const FitFiles& files, FitData& data) {
  if (!files.observe_velocity) return;
  for (std::vector<Log>* group : {&data.logs, &data.holdout}) {
    const auto settles = [](const Log& log) {
      return log.sample_count() > MotionObserver(1, log.period_s).ticks_to_settle();
    };
    const auto end = std::stable_partition(group->begin(), group->end(), settles);
    if (end != group->begin()) group->erase(end, group->end());
    for (Log& log : *group) log = as_observed(log);
  }
}

std::string file_names(const std::vector<std::string>& files) {
  return as_utf8(list_of(files, input_name));
}

}  // namespace offnominal::desk
