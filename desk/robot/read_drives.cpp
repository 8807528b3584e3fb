#include "robot/read_drives.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "common/number.hpp"
#include "common/toml_table.hpp"
#include "drives/drive_table.hpp"

namespace offnominal::desk {
namespace {

std::vector<std::string> names_of(std::span<const DriveProtocol> protocols) {
  std::vector<std::string> names;
  for (const DriveProtocol& protocol : protocols) names.emplace_back(protocol.name);
  return names;
}

// Of the protocol that the table names; of all, where it names none that there is.
std::vector<std::string> keys_for(const toml::table& table) {
  const auto name = table["protocol"].value<std::string>();
  const auto protocols = drive_protocols();
  const bool known =
      std::any_of(protocols.begin(), protocols.end(),
                  [&](const DriveProtocol& protocol) { return protocol.name == name; });
  std::vector<std::string> keys = drives_keys();
  for (const DriveProtocol& protocol : protocols) {
    if (known && protocol.name != name) continue;
    for (const auto& list : {protocol.keys, protocol.joint_keys}) {
      for (const hal::DriveKey& key : list) keys.emplace_back(key.name);
    }
  }
  return keys;
}

NumberRule rule_of(const hal::DriveKey& key) {
  NumberRule rule;
  rule.min = key.least;
  rule.max = key.most;
  rule.unit = key.unit;
  return rule;
}

double read_shared(const TomlTable& table, const hal::DriveKey& key) {
  if (!key.required && !table.has(key.name)) return key.otherwise;
  if (!key.words.empty()) {
    return static_cast<double>(table.choice(key.name, {key.words.begin(), key.words.end()}));
  }
  if (!key.whole) return table.number(key.name, rule_of(key));
  return static_cast<double>(table.integer(key.name, static_cast<std::int64_t>(key.least),
                                           static_cast<std::int64_t>(key.most)));
}

std::vector<double> read_per_joint(const TomlTable& table, const hal::DriveKey& key,
                                   std::size_t joints) {
  if (!key.required && !table.has(key.name)) return std::vector<double>(joints, key.otherwise);
  std::vector<double> values = table.numbers(key.name, rule_of(key), joints, joints);
  for (std::size_t j = 0; j < joints; ++j) {
    if (key.whole && values[j] != std::round(values[j])) {
      table.refuse(key.name, shortest(values[j]),
                   "whole numbers from " + shortest(key.least) + " to " + shortest(key.most),
                   "correct joint " + std::to_string(j + 1));
    }
    const auto end = values.begin() + static_cast<std::ptrdiff_t>(j);
    const auto same = std::find(values.begin(), end, values[j]);
    if (!key.differs || same == end) continue;
    table.refuse(key.name,
                 shortest(values[j]) + " for joints " + std::to_string(same - values.begin() + 1) +
                     " and " + std::to_string(j + 1),
                 "another one for every joint",
                 "give each drive its own, here and in its settings");
  }
  return values;
}

// The first joint with that fault, from 0; none where it is not of one.
std::optional<std::size_t> joint_at_fault(const DriveProtocol& protocol,
                                          const DriveSettings& settings,
                                          const hal::DriveFault& fault, double period_s) {
  const std::size_t keys = protocol.joint_keys.size();
  const auto is_fault = [&](const hal::DriveKey& key) {
    return std::string_view(key.name) == fault.key;
  };
  if (std::none_of(protocol.joint_keys.begin(), protocol.joint_keys.end(), is_fault)) {
    return std::nullopt;
  }
  for (std::size_t joint = 0; joint * keys < settings.of_joints.size(); ++joint) {
    const auto alone = std::span<const double>(settings.of_joints).subspan(joint * keys, keys);
    if (protocol.fault_of({settings.shared, alone}, period_s).key != nullptr) return joint;
  }
  return std::nullopt;
}

}  // namespace

const std::vector<std::string>& drives_keys() {
  static const std::vector<std::string> keys{"protocol", "source"};
  return keys;
}

DriveSettings read_drives(const toml::table& raw, const std::string& file, int joint_count,
                          double period_s) {
  const TomlTable table(file, "drives", raw, keys_for(raw));
  DriveSettings settings;
  settings.protocol = table.choice("protocol", names_of(drive_protocols()));
  settings.source = table.text_or_empty("source");
  const DriveProtocol& protocol = protocol_of(settings);
  for (const hal::DriveKey& key : protocol.keys) {
    settings.shared.push_back(read_shared(table, key));
  }
  const auto joints = static_cast<std::size_t>(joint_count);
  const std::size_t keys = protocol.joint_keys.size();
  settings.of_joints.resize(keys * joints);
  for (std::size_t k = 0; k < keys; ++k) {
    const std::vector<double> values = read_per_joint(table, protocol.joint_keys[k], joints);
    for (std::size_t j = 0; j < joints; ++j) settings.of_joints[j * keys + k] = values[j];
  }
  const hal::DriveFault fault = protocol.fault_of(values_of(settings), period_s);
  if (fault.key == nullptr) return settings;
  const auto joint = joint_at_fault(protocol, settings, fault, period_s);
  table.refuse(fault.key,
               joint ? fmt::format("{} for joint {}", fault.found, *joint + 1) : fault.found,
               fault.allowed,
               joint ? fmt::format("correct number {} of the list", *joint + 1)
                     : "docs/robot-file.md has what every key means");
}

}  // namespace offnominal::desk
