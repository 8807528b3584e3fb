#include "studio/file_groups.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>

#include "common/nearest.hpp"
#include "look/looked_columns.hpp"
#include "look/roles.hpp"

namespace offnominal::desk::studio {
namespace {

// "current" of "2:current".
std::string without_file(const std::string& source) {
  const std::size_t digits = source.find_first_not_of("0123456789");
  const bool has_file = digits != std::string::npos && digits > 0 && source[digits] == ':';
  return has_file ? source.substr(digits + 1) : source;
}

bool names_any(const Channel& channel, const NamedColumns& columns) {
  if (!channel.source.empty() && columns.columns.contains(without_file(channel.source))) {
    return true;
  }
  return std::any_of(channel.sum.begin(), channel.sum.end(),
                     [&](const Channel& term) { return names_any(term, columns); });
}

SignalsIn by_channels(const ChannelMap& map, const NamedColumns& columns) {
  const auto any = [&](const std::vector<Channel>& channels) {
    return std::any_of(channels.begin(), channels.end(),
                       [&](const Channel& one) { return names_any(one, columns); });
  };
  SignalsIn has{any(map.position), false, any(map.torque)};
  for (const auto& one : map.velocity) has.velocity |= one && names_any(*one, columns);
  return has;
}

bool has_any(const SignalsIn& has) { return has.position || has.velocity || has.torque; }

bool share_any(const SignalsIn& a, const SignalsIn& b) {
  return (a.position && b.position) || (a.velocity && b.velocity) || (a.torque && b.torque);
}

SignalsIn both(const SignalsIn& a, const SignalsIn& b) {
  return {a.position || b.position, a.velocity || b.velocity, a.torque || b.torque};
}

// Characters that two names begin and end with alike.
std::size_t likeness(const std::string& a, const std::string& b) {
  const std::size_t most = std::min(a.size(), b.size());
  const auto begin =
      std::mismatch(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(most), b.begin());
  const auto end =
      std::mismatch(a.rbegin(), a.rbegin() + static_cast<std::ptrdiff_t>(most), b.rbegin());
  const auto alike = static_cast<std::size_t>(std::distance(a.begin(), begin.first) +
                                              std::distance(a.rbegin(), end.first));
  return std::min(alike, most);
}

struct Pair {
  std::size_t first;
  std::size_t further;
  std::size_t likeness;
};

}  // namespace

SignalsIn signals_in(const NamedColumns& columns, const RobotDescription& robot) {
  if (robot.channels) {
    const SignalsIn has = by_channels(*robot.channels, columns);
    if (has_any(has)) return has;
  }
  if (!columns.has_names) return {};
  const Roles roles = roles_of(columns_of(look_of(columns)), expected_of(&robot));
  return {!roles.position.empty(), !roles.velocity.empty(), !roles.torque.empty()};
}

std::vector<std::vector<std::size_t>> groups_of(const std::vector<FileToGroup>& files) {
  std::vector<Pair> pairs;
  for (std::size_t first = 0; first < files.size(); ++first) {
    for (std::size_t further = 0; further < files.size(); ++further) {
      if (!files[first].has.position || !has_any(files[further].has)) continue;
      if (share_any(files[first].has, files[further].has)) continue;
      pairs.push_back({first, further, likeness(files[first].name, files[further].name)});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.likeness > b.likeness; });
  std::vector<std::vector<std::size_t>> further_of(files.size());
  std::vector<SignalsIn> has;
  for (const FileToGroup& file : files) has.push_back(file.has);
  std::vector<char> is_taken(files.size(), 0);
  for (const Pair& pair : pairs) {
    if (is_taken[pair.further] != 0 || share_any(has[pair.first], files[pair.further].has))
      continue;
    is_taken[pair.further] = 1;
    has[pair.first] = both(has[pair.first], files[pair.further].has);
    further_of[pair.first].push_back(pair.further);
  }
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (is_taken[i] != 0) continue;
    std::sort(further_of[i].begin(), further_of[i].end());
    groups.push_back({i});
    groups.back().insert(groups.back().end(), further_of[i].begin(), further_of[i].end());
  }
  return groups;
}

std::string words_of(const std::vector<FileToGroup>& group) {
  return list_of(group, [](const FileToGroup& file) {
    std::vector<std::string> what;
    if (file.has.position) what.emplace_back("positions");
    if (file.has.velocity) what.emplace_back("velocities");
    if (file.has.torque) what.emplace_back("torques");
    return list_of(what) + " in " + file.name;
  });
}

}  // namespace offnominal::desk::studio
