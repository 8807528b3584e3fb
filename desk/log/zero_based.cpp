#include "log/zero_based.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "common/nearest.hpp"
#include "log/channel_needs.hpp"

namespace offnominal::desk {
namespace {

// A quantity's columns, by the number in their name.
struct Counted {
  std::string prefix;
  std::set<int> joints;

  [[nodiscard]] bool from_zero() const { return joints.contains(0); }
  [[nodiscard]] bool is_for(int count) const {
    return static_cast<int>(joints.size()) == count && *joints.rbegin() == count - 1;
  }
  // "q0 to q6"
  [[nodiscard]] std::string words() const {
    if (joints.size() > 1 && *joints.rbegin() - *joints.begin() + 1 == std::ssize(joints)) {
      return fmt::format("{0}{1} to {0}{2}", prefix, *joints.begin(), *joints.rbegin());
    }
    return list_of(joints, [&](int joint) { return fmt::format("{}{}", prefix, joint); });
  }
};

std::vector<Counted> counted_in(const NamedColumns& columns, Eigen::Index samples) {
  std::vector<Counted> all;
  for (const char* prefix : {"q", "dq", "tau"}) {
    Counted counted{prefix, {}};
    for (const auto& [name, values] : columns.columns) {
      const std::optional<int> number = number_behind(name, prefix);
      if (number && values.size() == samples) counted.joints.insert(*number);
    }
    if (!counted.joints.empty()) all.push_back(std::move(counted));
  }
  return all;
}

template <typename Named>
void rename(Named& named, const std::string& from, const std::string& to) {
  auto one = named.extract(from);
  if (one.empty()) return;
  one.key() = to;
  named.insert(std::move(one));
}

}  // namespace

void count_joints_from_one(NamedColumns& columns, Eigen::Index samples, int joints) {
  const std::vector<Counted> all = counted_in(columns, samples);
  if (std::none_of(all.begin(), all.end(), [](const Counted& one) { return one.from_zero(); })) {
    return;
  }
  const std::string found = list_of(all, [](const Counted& one) { return one.words(); });
  const std::string allowed =
      fmt::format("q, tau (and dq) of the robot's {} joint{}, all from 1 or all from 0", joints,
                  joints == 1 ? "" : "s");
  if (!std::all_of(all.begin(), all.end(), [](const Counted& one) { return one.from_zero(); })) {
    throw InputError({columns.file, "columns", found + ": some count from 0, some do not", allowed,
                      "rename them, or say with [channels] which column is of which joint"});
  }
  for (const Counted& one : all) {
    const bool may_lack = one.prefix == "dq" && *one.joints.rbegin() < joints;
    if (may_lack || one.is_for(joints)) continue;
    throw InputError(
        {columns.file, "columns",
         fmt::format("{}, {} of {}, numbered from 0", found, one.joints.size(), one.prefix),
         allowed,
         "take the robot file of the robot that was recorded, or say with [channels] which column "
         "is of which joint"});
  }
  // The last first: its new name is free.
  for (const Counted& one : all) {
    for (auto joint = one.joints.rbegin(); joint != one.joints.rend(); ++joint) {
      const std::string from = one.prefix + std::to_string(*joint);
      const std::string to = one.prefix + std::to_string(*joint + 1);
      rename(columns.columns, from, to);
      rename(columns.units, from, to);
      std::replace(columns.names.begin(), columns.names.end(), from, to);
    }
  }
  columns.remarks.emplace_back("the joints are numbered from 0: q0 is joint 1");
}

}  // namespace offnominal::desk
