#include "log/column_values.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "common/nearest.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// No measurement is larger; squares and sums of it stay within what numbers can hold.
constexpr double kLargest = 1e15;

[[noreturn]] void refuse(const NamedColumns& columns, const std::string& place,
                         const std::string& found, const std::string& allowed,
                         const std::string& mend = {}) {
  throw InputError({columns.file, place, found, allowed, mend});
}

[[noreturn]] void refuse_value(const NamedColumns& columns, double value, const std::string& place,
                               const std::string& what) {
  const std::string allowed = fmt::format("a number up to {:g}", kLargest);
  refuse(columns, place, fmt::format("{:g}", value), allowed,
         what == kTimeWords
             ? "say its unit, unit = \"ns\" under [channels.time] for nanoseconds"
             : "say its unit with unit or scale under [channels], or mend the number where it is "
               "made");
}

double scalar(const NamedColumns& columns, const std::string& name, const std::string& what) {
  if (const auto found = columns.scalars.find(name); found != columns.scalars.end()) {
    if (std::isfinite(found->second) && found->second != 0) return found->second;
    refuse(columns, "variable " + name, fmt::format("{}", found->second),
           "a finite number other than 0");
  }
  const auto column = columns.columns.find(name);
  if (column == columns.columns.end()) {
    refuse(columns, "columns", names_found(columns),
           "a number \"" + name + "\" that scales the " + what);
  }
  const VectorXd& values = column->second;
  if (values.size() == 0 || (values.array() != values[0]).any() || !std::isfinite(values[0])) {
    refuse(columns, "variable " + name, "values that change",
           "one finite number that scales the " + what);
  }
  return values[0];
}

// Of a channel that is no sum.
VectorXd values_of_source(NamedColumns& columns, const Channel& channel, const std::string& what,
                          bool last) {
  const auto column = columns.columns.find(channel.source);
  if (column == columns.columns.end()) {
    if (columns.scalars.contains(channel.source)) {
      refuse(columns, "variable " + channel.source, "a single number",
             "one value per sample, for the " + what);
    }
    if (columns.taken.contains(channel.source)) {
      refuse(columns, "column " + channel.source, "the same column for two quantities",
             "a column of its own for the " + what, "give another one of them under [channels]");
    }
    refuse(columns, "columns", names_found(columns),
           "a column \"" + channel.source + "\" for the " + what, kMendNames);
  }
  double scale = channel.scale * unit_factor(channel.unit);
  if (!channel.scale_source.empty()) scale *= scalar(columns, channel.scale_source, what);
  VectorXd values;
  if (last) {
    values = std::move(column->second);
    columns.columns.erase(column);
    columns.taken.insert(channel.source);
  } else {
    values = column->second;
  }
  if (scale != 1) values *= scale;
  if (channel.offset != 0) values.array() += channel.offset;
  for (Index row = 0; row < values.size(); ++row) {
    if (!(std::abs(values[row]) > kLargest) || std::isinf(values[row])) continue;
    refuse_value(columns, values[row], columns.place_of(row) + ", " + channel.source, what);
  }
  return values;
}

const char* si_of(ChannelQuantity quantity) {
  switch (quantity) {
    case ChannelQuantity::kTime:
      return "s";
    case ChannelQuantity::kPosition:
      return "rad, or m of a slide";
    case ChannelQuantity::kVelocity:
      return "rad/s, or m/s of a slide";
    case ChannelQuantity::kTorque:
      return "N m, or N of a slide";
    case ChannelQuantity::kMotorPosition:
      return "rad";
    case ChannelQuantity::kMotorVelocity:
      return "rad/s";
    case ChannelQuantity::kMotorTorque:
      return "N m";
    case ChannelQuantity::kCurrent:
      return "A";
  }
  return "";
}

void remark_unit_in_name(NamedColumns& columns, const std::string& name, ChannelQuantity quantity) {
  const std::string text = unit_in_name(name);
  if (text.empty()) return;
  const SourceUnit* const unit = find_unit(text);
  if (unit == nullptr) {
    columns.remarks.push_back("column " + name + ": " + words_of_unknown_unit(text, quantity));
  } else if (unit->factor != 1) {
    columns.remarks.push_back(
        fmt::format("column {}: taken as {}, since no unit is said of it; unit = \"{}\" under "
                    "[channels] takes that of its name",
                    name, si_of(quantity), text));
  }
}

}  // namespace

std::string unit_in_name(const std::string& name) {
  if (name.size() <= 2 || (name.back() != ']' && name.back() != ')')) return {};
  const auto open = name.find_last_of("[(");
  if (open == std::string::npos) return {};
  std::string inner = name.substr(open + 1, name.size() - open - 2);
  const bool is_number = inner.empty() || inner.find_first_of(",:") != std::string::npos ||
                         inner.find_first_not_of("0123456789") == std::string::npos;
  return is_number ? std::string() : inner;
}

std::string words_of_unknown_unit(const std::string& unit, ChannelQuantity quantity) {
  return fmt::format("\"{}\" is no unit that is known: taken as {}", unit, si_of(quantity));
}

std::string names_found(const NamedColumns& columns) {
  constexpr std::size_t kMost = 40;
  std::vector<std::string> names = columns.names;
  if (names.size() > kMost) {
    names.resize(kMost);
    names.emplace_back("...");
  }
  return list_of(names);
}

VectorXd take_values(NamedColumns& columns, const Channel& channel, const std::string& what,
                     bool last) {
  if (channel.sum.empty()) return values_of_source(columns, channel, what, last);
  VectorXd sum;
  for (const Channel& term : channel.sum) {
    const VectorXd values = values_of_source(columns, term, what, false);
    if (sum.size() == 0) {
      sum = values;
    } else if (sum.size() == values.size()) {
      sum += values;
    } else {
      refuse(columns, "variable " + term.source, fmt::format("{} values", values.size()),
             fmt::format("{}, as many as the other terms of the {} have", sum.size(), what));
    }
  }
  double scale = channel.scale * unit_factor(channel.unit);
  if (!channel.scale_source.empty()) scale *= scalar(columns, channel.scale_source, what);
  sum = (scale * sum).array() + channel.offset;
  for (Index row = 0; row < sum.size(); ++row) {
    if (std::abs(sum[row]) > kLargest && !std::isinf(sum[row])) {
      refuse_value(columns, sum[row], columns.place_of(row) + ", the sum", what);
    }
  }
  return sum;
}

void take_unit_of_file(NamedColumns& columns, Channel& channel, ChannelQuantity quantity,
                       const std::string& what) {
  if (!channel.unit.empty() || channel.scale != 1 || !channel.scale_source.empty() ||
      !channel.sum.empty()) {
    return;
  }
  const auto said = columns.units.find(channel.source);
  if (said == columns.units.end()) return remark_unit_in_name(columns, channel.source, quantity);
  const SourceUnit* const unit = find_unit(said->second);
  if (unit == nullptr) {
    columns.remarks.push_back(fmt::format("column {}: {}", channel.source,
                                          words_of_unknown_unit(said->second, quantity)));
    return;
  }
  if (!is_unit_of(*unit, quantity)) {
    refuse(
        columns, "column " + channel.source, "the unit " + said->second + ", as the file says",
        fmt::format("{} for the {}; any other unit with its scale", units_of(quantity), what),
        fmt::format("write {{source = \"{}\", unit = \"{}\", scale = ...}} under [channels], the "
                    "scale being what one {} is in SI",
                    channel.source, said->second, si_name(unit->dimension)));
  }
  channel.unit = said->second;
  if (unit->factor == 1) return;
  columns.remarks.push_back(fmt::format("the {} is read in {}, as the file says of {}", what,
                                        said->second, channel.source));
}

}  // namespace offnominal::desk
