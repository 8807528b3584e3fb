#include <fmt/format.h>

#include <algorithm>

#include "common/number.hpp"
#include "look/look_report.hpp"
#include "robot/channel_text.hpp"

namespace offnominal::desk {
namespace {

// {source = "2"} of a file without names: 2; {source = "2", unit = "deg"}: {source = 2, ...}.
std::string with_numbers(std::string line) {
  constexpr std::string_view kSource = "{source = \"";
  for (auto at = line.find(kSource); at != std::string::npos; at = line.find(kSource, at + 1)) {
    const auto begin = at + kSource.size();
    const auto end = line.find('"', begin);
    const std::string number = line.substr(begin, end - begin);
    const bool alone = line[end + 1] == '}';
    line.replace(at, end + (alone ? 2 : 1) - at, alone ? number : "{source = " + number);
  }
  return line;
}

std::string pasted_lines(const Look& look, const char* quantity) {
  std::string text;
  for (const std::string& line : channel_lines(look.channels, quantity)) {
    text += look.has_names ? line : with_numbers(line);
    text += look.guessed ? "   # guessed\n" : "\n";
  }
  return text;
}

}  // namespace

std::string channels_text(const Look& look) {
  const ChannelMap& map = look.channels;
  std::string text = "[channels]\n";
  if (map.at_rest) {
    text += "at_rest = true\n";
  } else if (map.period_s > 0) {
    text += "period_s = " + shortest_real(map.period_s) + "\n";
  } else {
    text += look.t_s ? pasted_lines(look, "time")
                     : "# period_s = ...    # or time = ..., the column that has it\n";
  }
  text += map.position.empty() ? "# position = [...]\n" : pasted_lines(look, "position");
  const bool any_velocity = std::any_of(map.velocity.begin(), map.velocity.end(),
                                        [](const auto& one) { return one.has_value(); });
  if (any_velocity) text += pasted_lines(look, "velocity");
  text += map.torque.empty() ? "# torque = [...]    # or motor_current = [...]\n"
                             : pasted_lines(look, "torque");
  for (const std::string& what : look.missing) text += "# still to be said: " + what + "\n";
  if (look.transmission.empty()) return text;
  text += "# [transmission]\n";
  for (const std::string& line : look.transmission) text += "# " + line + "\n";
  return text;
}

}  // namespace offnominal::desk
