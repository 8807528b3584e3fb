#include "controller/outcome.hpp"

#include <fmt/format.h>

#include "common/text_table.hpp"
#include "sil/sil_report.hpp"

namespace offnominal::desk {

nlohmann::ordered_json to_json(const ControllerOutcome& outcome) {
  const realtime::LoopReport& loop = outcome.report.loop;
  const realtime::Grant& grant = outcome.report.grant;
  nlohmann::ordered_json json;
  json["state"] = sil::name_of(loop.state);
  json["fault"] = controller::name_of(loop.fault);
  json["fault_number"] = static_cast<int>(loop.fault);
  json["refusal"] = controller::name_of(loop.refusal);
  json["refusal_number"] = static_cast<int>(loop.refusal);
  json["detection_time_s"] = loop.detected ? nlohmann::ordered_json(loop.detection_time_s)
                                           : nlohmann::ordered_json(nullptr);
  json["first_joint"] = loop.first_joint < 0 ? nlohmann::ordered_json(nullptr)
                                             : nlohmann::ordered_json(loop.first_joint + 1);
  json["act_time_s"] =
      loop.acts ? nlohmann::ordered_json(loop.act_time_s) : nlohmann::ordered_json(nullptr);
  json["act_joint"] = loop.act_joint < 0 ? nlohmann::ordered_json(nullptr)
                                         : nlohmann::ordered_json(loop.act_joint + 1);
  json["slowed"] = nullptr;
  if (loop.slowed) {
    json["slowed"] = {{"time_s", loop.slow_time_s},
                      {"to", loop.slow_down.to},
                      {"within_s", loop.slow_down.within_s}};
  }
  json["isolated"] = nullptr;
  if (outcome.report.isolated) {
    json["isolated"] = to_json(*outcome.report.isolated, outcome.joint_names);
  }
  json["ticks"] = loop.ticks;
  json["overruns"] = loop.overruns;
  json["ticks_left_out"] = loop.left_out;
  json["worst_late_us"] = loop.worst_late_us;
  json["worst_step_us"] = loop.worst_step_us;
  json["mean_step_us"] = loop.mean_step_us;
  json["real_time"] = {{"fifo_priority", grant.priority}, {"memory_locked", grant.locked}};
  json["bus"] = {{"name", outcome.bus_name},
                 {"sent", outcome.bus.sent},
                 {"received", outcome.bus.received},
                 {"lost", outcome.report.counts.lost},
                 {"rejected", outcome.report.counts.rejected},
                 {"stale", loop.missed_samples},
                 {"late", outcome.bus.late},
                 {"not_taken", loop.unsent_frames},
                 {"overflow", outcome.bus.receive_overflow},
                 {"errors", outcome.bus.errors}};
  json["recording_lost"] = outcome.recording_lost;
  return json;
}

std::string text_of(const ControllerOutcome& outcome) {
  const realtime::LoopReport& loop = outcome.report.loop;
  const hal::BusState& bus = outcome.bus;
  const TextTable table({{"", -46}, {"", 0}});
  std::string text;
  const auto row = [&](const char* name, const std::string& value) {
    text += table.row(name, value);
  };
  row("at the end",
      loop.fault == controller::Fault::kNone
          ? sil::name_of(loop.state)
          : fmt::format("{}; first fault: {} ({})", sil::name_of(loop.state),
                        controller::name_of(loop.fault), static_cast<int>(loop.fault)));
  if (loop.refusal != controller::Fault::kNone) {
    row("not armed",
        fmt::format("{} ({})", controller::name_of(loop.refusal), static_cast<int>(loop.refusal)));
  }
  row("detected", loop.detected ? fmt::format("{:.3f} s after arming", loop.detection_time_s)
                                : std::string("nothing"));
  if (loop.first_joint >= 0) row("first joint off nominal", std::to_string(loop.first_joint + 1));
  if (loop.detected) {
    const std::string of_joint =
        loop.act_joint < 0 ? std::string() : fmt::format(", joint {}", loop.act_joint + 1);
    row("beyond the level to act",
        loop.acts ? fmt::format("{:.3f} s after arming{}", loop.act_time_s, of_joint)
                  : std::string("never"));
  }
  if (loop.slowed) {
    row("motion slowed",
        fmt::format("{:.3f} s after arming, {}", loop.slow_time_s, slowing_words(loop.slow_down)));
  }
  if (outcome.report.isolated) {
    row("which fault", words_of(*outcome.report.isolated, outcome.joint_names));
  }
  row("ticks", std::to_string(loop.ticks));
  row("overruns (ticks a period or more too late)", std::to_string(loop.overruns));
  row("ticks that they cost", std::to_string(loop.left_out));
  row("latest begin of a tick", fmt::format("{} us", loop.worst_late_us));
  row("a tick's work, mean and longest",
      fmt::format("{:.0f} us, {} us", loop.mean_step_us, loop.worst_step_us));
  row("real time", words_of(outcome.report.grant));
  row("late frames in the kernel",
      outcome.can_take_back ? "taken back by restarting the interface" : "cannot be taken back");
  row("bus", outcome.bus_name);
  row("frames sent, received", fmt::format("{}, {}", bus.sent, bus.received));
  row("lost, by their counters", std::to_string(outcome.report.counts.lost));
  row("rejected (CRC, counter, value)", std::to_string(outcome.report.counts.rejected));
  row("ticks without a fresh reading", std::to_string(loop.missed_samples));
  row("not sent for lateness", std::to_string(bus.late));
  row("entries that the recording lost", std::to_string(outcome.recording_lost));
  return text;
}

}  // namespace offnominal::desk
