#include "studio/preview.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <offnominal/model/quantity.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "common/error.hpp"
#include "common/nearest.hpp"
#include "compare/compare.hpp"
#include "explain/data_fault_report.hpp"
#include "explain/explain.hpp"
#include "log/log_of.hpp"
#include "log/read_log.hpp"
#include "log/sampling.hpp"
#include "report/decimate.hpp"
#include "robot/payload.hpp"
#include "robot/transmission.hpp"
#include "robot/units.hpp"
#include "studio/signal_map.hpp"

namespace offnominal::desk::studio {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using nlohmann::ordered_json;

// As a verb reads it from a file of these channels.
Log log_from(const GivenRecording& recording, const RobotDescription& robot,
             const ChannelMap& channels) {
  const ChannelMap map = read_back(channels, "[channels]");
  check_sides(map, robot.transmission, "[channels]");
  Log log = log_of(recording.timed(map), robot, map);
  log.payload = payload_of(map.payloads, recording.path());
  return log;
}

ordered_json finite_or_null(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

struct Curve {
  ordered_json t_s = ordered_json::array();
  ordered_json values = ordered_json::array();
};

Curve curve_of(const VectorXd& t_s, const Eigen::Ref<const VectorXd>& values, std::size_t pixels) {
  report::Series series;
  series.x.assign(t_s.begin(), t_s.end());
  series.y.assign(values.begin(), values.end());
  series = report::decimate(series, std::max(2 * pixels, report::kMinDecimatedPoints));
  Curve curve;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    curve.t_s.push_back(finite_or_null(series.x[i]));
    curve.values.push_back(finite_or_null(series.y[i]));
  }
  return curve;
}

ordered_json signal_of(const char* quantity, std::size_t joint, const std::string& unit,
                       const VectorXd& t_s, const Eigen::Ref<const VectorXd>& values,
                       std::size_t pixels) {
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = low;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::fmin(low, value);
    high = std::fmax(high, value);
  }
  Curve curve = curve_of(t_s, values, pixels);
  return {{"quantity", quantity},
          {"joint", joint + 1},
          {"unit", unit},
          {"low", finite_or_null(low)},
          {"high", finite_or_null(high)},
          {"t_s", std::move(curve.t_s)},
          {"values", std::move(curve.values)},
          {"derived", ordered_json::array()}};
}

std::string si_unit(std::string_view quantity, JointType type) {
  if (quantity == "position") return unit_of(Quantity::kPosition, type);
  return unit_of(quantity == "velocity" ? Quantity::kVelocity : Quantity::kEffort, type);
}

ordered_json signals_of(const Log& log, const RobotDescription& robot, std::size_t pixels) {
  Log of_positions = log;
  of_positions.dq_derived.assign(log.dq_derived.size(), true);
  if (!log.at_rest) derive_velocities(of_positions);
  ordered_json all = ordered_json::array();
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const auto at = static_cast<Index>(i);
    const JointType type = robot.joints[i].joint.type;
    const auto add = [&](const char* quantity, const Eigen::MatrixXd& values) {
      all.push_back(
          signal_of(quantity, i, si_unit(quantity, type), log.t_s, values.col(at), pixels));
    };
    add("position", log.q);
    if (!log.at_rest) add("velocity", log.dq);
    if (!log.at_rest && !log.dq_derived[i]) {
      Curve curve = curve_of(log.t_s, of_positions.dq.col(at), pixels);
      all.back()["derived"] = std::move(curve.values);
      all.back()["derived_t_s"] = std::move(curve.t_s);
    }
    add("torque", log.tau);
  }
  return all;
}

// By their columns alone, since all of them together are no recording.
ordered_json raw_signals(const GivenRecording& recording, const RobotDescription& robot,
                         const ChannelMap& map, std::size_t pixels) {
  ordered_json all = ordered_json::array();
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    for (const char* quantity : {"position", "velocity", "torque"}) {
      const Channel* channel = channel_of(map, quantity, i);
      const bool is_velocity = std::string_view(quantity) == "velocity";
      if (channel == nullptr || (map.at_rest && is_velocity)) continue;
      const VectorXd* const found = recording.values_of(channel->source);
      if (found == nullptr || found->size() < 2) continue;
      const JointType type = robot.joints[i].joint.type;
      const std::string unit =
          unit_read(*channel, quantity, side_of(map, quantity, i), type, recording.columns());
      const VectorXd values = channel->scale * *found;
      const VectorXd rows =
          VectorXd::LinSpaced(values.size(), 0, static_cast<double>(values.size() - 1));
      all.push_back(signal_of(quantity, i, unit, rows, values, pixels));
    }
  }
  return all;
}

std::string sampling_words(const Log& log) {
  if (log.at_rest) return fmt::format("{} readings at rest", log.sample_count());
  return fmt::format("{} samples, {:.6g} s, {:.6g} Hz", log.sample_count(),
                     log.t_s[log.t_s.size() - 1] - log.t_s[0], log.sample_rate_hz());
}

ordered_json faults_json(const std::vector<DataFault>& faults) {
  ordered_json all = to_json(faults);
  for (std::size_t i = 0; i < faults.size(); ++i) {
    all[i]["certain"] = faults[i].certain;
    all[i]["spoils"] = spoils(faults[i], RestsOn::kTorque);
  }
  return all;
}

}  // namespace

ordered_json preview_of(const GivenRecording& recording, const RobotDescription& robot,
                        const ChannelMap& map, std::size_t pixels) {
  ordered_json json{{"error", nullptr}, {"remarks", ordered_json::array()}, {"sampling", nullptr}};
  try {
    const std::vector<std::string> missing = missing_of(map);
    if (!missing.empty()) {
      throw InputError(
          {recording.name(), "", "no column for " + list_of(missing), "", "choose them"});
    }
    const Log log = log_from(recording, robot, map);
    json["remarks"] = log.remarks;
    json["sampling"] = sampling_words(log);
    json["signals"] = signals_of(log, robot, pixels);
  } catch (const InputError& error) {
    json["error"] = error.what();
    json["signals"] = raw_signals(recording, robot, map, pixels);
  }
  return json;
}

void check_readable(const GivenRecording& recording, const RobotDescription& robot,
                    const ChannelMap& map) {
  static_cast<void>(log_from(recording, robot, map));
}

ordered_json findings_of(const GivenRecording& recording, const RobotDescription& robot,
                         const ChannelMap& map, const std::vector<KeepFault>& keep,
                         std::size_t pixels) {
  std::vector<Log> logs;
  logs.push_back(log_from(recording, robot, map));
  if (logs.front().at_rest) {
    return {{"error",
             "the data doctor and compare are of recordings in time, these are readings at rest"},
            {"faults", ordered_json::array()},
            {"joints", ordered_json::array()}};
  }
  const std::vector<DataFault> faults = treat_all({logs}, robot, keep);
  ordered_json json{
      {"error", nullptr}, {"faults", faults_json(faults)}, {"joints", ordered_json::array()}};
  try {
    const Comparison compared = compare(robot, measure(std::move(logs.front()), robot));
    for (const JointComparison& joint : compared.joints) {
      Curve curve =
          curve_of(compared.t_s, compared.model.col(static_cast<Index>(joint.joint)), pixels);
      json["joints"].push_back({{"joint", joint.joint + 1},
                                {"error_percent", finite_or_null(joint.relative_error_percent)},
                                {"t_s", std::move(curve.t_s)},
                                {"model", std::move(curve.values)}});
    }
  } catch (const InputError& error) {
    json["error"] = error.what();
  }
  return json;
}

}  // namespace offnominal::desk::studio
