#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "live/bus_samples.hpp"
#include "live/feed.hpp"
#include "live/history.hpp"
#include "replay/watch.hpp"
#include "report/page.hpp"
#include "robot/robot.hpp"
#include "sil/sil.hpp"

namespace offnominal::desk::live {

/// What a live view is given.
struct LiveInput {
  RobotDescription robot;
  std::string robot_file;                 // as the user named it
  std::optional<std::string> bus;         // a CAN interface; none: a run that is simulated
  sil::Scenario scenario;                 // of that run, of robot files and MuJoCo's alone
  std::optional<std::string> plant_file;  // of it, as the user named it; none: the robot's
  std::filesystem::path folder;  // where recordings are written; empty: the working directory
};

/// What is kept of before and after a detection, s: to be looked at, and to be explained; of the
/// latter as much as has come when it is asked for.
inline constexpr double kBeforeS = 5;
inline constexpr double kAfterS = 2;
inline constexpr double kExplainedBeforeS = 10;
inline constexpr double kExplainedAfterS = 20;
/// The longest recording, s: it is held in memory until it is written.
inline constexpr double kLongestRecordingS = 300;

/// Something that is judged by itself: a joint in torque space, all joints together in the other.
struct Judged {
  std::string name;
  std::string unit;  // of residual and threshold
};

/// A detection, with what isolation says of it.
struct Detection {
  std::uint64_t number = 0;       // from 1
  double t_s = 0;                 // of the live view
  int joint = -1;                 // from 0, that was first; -1: joints are not told apart
  std::optional<double> act_t_s;  // when the second level was reached; none: it was not
  int act_joint = -1;             // from 0, whose it was; -1: joints are not told apart
  std::optional<IsolatedFault> answer;
  bool frozen = false;                   // its surroundings are there
  History::Rows rows;                    // those
  std::optional<History::Rows> stretch;  // for the analysis; none: more of it is to come
};

/// What a page shows of one moment. Numbers that there are not are NaN.
struct Moment {
  double t_s = 0;                 // of the newest sample
  std::vector<double> residual;   // |e| of everything that is judged
  std::vector<double> threshold;  // NaN without a bound
  std::vector<double> act;        // the second level; NaN where it is the first
  std::vector<bool> beyond;       // its threshold, now
  bool is_driven = false;         // the drives give torque
  bool is_judging = false;        // and the threshold has settled
  std::string words;              // what keeps samples from coming; empty: nothing
  std::string ended;              // why none come any more; empty: they may
  std::optional<ControllerWord> controller;
  std::optional<Detection> detection;  // without its rows
  std::vector<sim::FaultEvent> faults;
  bool accommodates = false;
  std::optional<double> recording_s;  // how long a recording is by now
  std::uint64_t frames = 0, understood = 0, lost = 0, rejected = 0, missing = 0, refused = 0,
                overflow = 0;
  Strip::Steps steps;
};

/// The monitor of a robot over a bus that is listened to, or over a run that is simulated, as it
/// happens. Every function may be called by any thread; they throw Refused where what is asked
/// cannot be done.
class Live {
 public:
  /// Begins at once. Throws InputError for a robot, a scenario or a bus that cannot be.
  explicit Live(LiveInput input);
  /// The same with frames of somewhere else; `input` names a bus.
  Live(LiveInput input, std::unique_ptr<Feed> feed);
  Live(const Live&) = delete;
  Live& operator=(const Live&) = delete;
  ~Live();

  [[nodiscard]] const LiveInput& input() const { return input_; }
  [[nodiscard]] bool has_bound() const { return has_bound_; }
  [[nodiscard]] bool has_two_levels() const { return has_two_levels_; }
  [[nodiscard]] bool is_simulated() const { return bench_ != nullptr; }
  [[nodiscard]] const std::vector<Judged>& judged() const { return judged_; }

  /// `from`: the first step that is not known yet.
  [[nodiscard]] Moment moment(std::uint64_t from) const;
  /// Isolation's answer in words.
  [[nodiscard]] std::string words_of(const IsolatedFault& fault) const;
  /// Residual and threshold around the last detection, a chart of each.
  [[nodiscard]] std::vector<report::Chart> frozen(std::size_t pixels) const;

  /// Of a run that is simulated. A fault of the same kind and joint takes the place of the one
  /// before.
  void add_fault(const std::string& kind, int joint, double size);
  void end_faults();
  void set_accommodation(bool on);
  /// The run from its start, or on a bus the monitor: what it has learnt and detected is forgotten.
  void begin_again();

  void start_recording();
  /// Writes it as a CSV in the common format, under the first name that is free, and returns that.
  std::string stop_recording();

  struct Written {
    std::string since;            // the detection: what there is to explain
    std::string before;           // it, when nothing was wrong yet
    std::uint64_t detection = 0;  // its number
  };
  /// The same of what is around the last detection, in two files.
  [[nodiscard]] Written write_detection() const;
  /// Of the last detection, from 1; 0: there is none.
  [[nodiscard]] std::uint64_t detection_number() const;

 private:
  void set_up();
  void run();
  void tell(std::function<void()> command);
  void do_what_was_told();
  void take(const hal::ReceivedFrame& received);
  bool knows_period(const BusSample& sample);
  void judge(const BusSample& sample);
  bool is_settled(const BusSample& sample, double t_s);
  void keep(const BusSample& sample, double t_s, const Watched& said);
  [[nodiscard]] double act_ratio(std::size_t joint, bool fast) const;
  void follow_detection(double t_s, const Watched& said);
  void freeze(double now_s);
  void after_frames();
  void forget();
  [[nodiscard]] std::string what_is_missing(hal::Microseconds now_us) const;
  [[nodiscard]] Bench& bench() const;
  [[nodiscard]] History::Rows stretch_of(const Detection& detection) const;
  [[nodiscard]] std::string write(const Log& log, const std::string& what) const;

  LiveInput input_;
  bool has_bound_ = false;
  bool has_two_levels_ = false;
  std::vector<Judged> judged_;
  std::vector<std::string> names_;  // of joints, for words
  std::unique_ptr<Feed> feed_;
  Bench* bench_ = nullptr;  // the same, where it is simulated

  // Of the thread that listens alone.
  RobotDescription watched_;  // with a bound, and the period of the readings
  std::unique_ptr<BusSamples> samples_;
  std::unique_ptr<Watch> watch_;
  std::vector<hal::Microseconds> first_us_;  // of samples, until their period is known
  bool period_known_ = false;
  std::uint32_t unjudged_ = 0;            // samples in a row
  std::optional<double> driven_since_s_;  // the drives have given torque
  bool begins_afresh_ = false;
  // Of the frames that samples_ had before it was made anew.
  std::uint64_t frames_before_ = 0, understood_before_ = 0;
  hal::DriveCounts counts_before_;
  bool was_latched_ = false;
  std::vector<double> residual_, threshold_, act_;
  std::optional<hal::Microseconds> begin_us_;
  hal::Microseconds last_sample_us_ = 0;

  mutable std::mutex lock_;  // of all that follows
  std::vector<std::function<void()>> commands_;
  History history_;
  Strip strip_;
  Moment now_;
  std::optional<Detection> detection_;
  std::uint64_t detections_ = 0;
  std::optional<std::vector<double>> recording_;  // t, q, dq, tau, row by row
  double period_s_ = 0;                           // of the samples
  std::atomic<bool> over_ = false;
  std::thread thread_;
};

}  // namespace offnominal::desk::live
