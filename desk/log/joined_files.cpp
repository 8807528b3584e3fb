#include "log/joined_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "common/nearest.hpp"
#include "common/time_words.hpp"
#include "log/channel_needs.hpp"
#include "robot/channel_text.hpp"
#include "robot/units.hpp"
#include "signal/fold.hpp"
#include "signal/resample.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// On the first file's clock.
struct Span {
  double first = 0;
  double last = 0;
};

[[noreturn]] void fail(const std::string& file, const std::string& place, const std::string& found,
                       const std::string& allowed, const std::string& mend) {
  throw InputError({file, place, found, allowed, mend});
}

void check_length(const TimedColumns& file) {
  for (const auto& [name, values] : file.columns.columns) {
    if (values.size() == file.time.t_s.size()) continue;
    fail(file.columns.file, "variable " + name, fmt::format("{} values", values.size()),
         fmt::format("{}, as many as the file's time has", file.time.t_s.size()),
         "map a column of that length");
  }
}

// Of a file's rows those with a number, and where they leave a gap.
struct Known {
  VectorXd t_s, values;
  std::vector<Span> gaps;
};

Known known_of(const VectorXd& t_s, const VectorXd& values, double most_gap) {
  Known known{VectorXd(t_s.size()), VectorXd(t_s.size()), {}};
  Index count = 0;
  for (Index row = 0; row < values.size(); ++row) {
    if (!std::isfinite(values[row])) continue;
    known.t_s[count] = t_s[row];
    known.values[count++] = values[row];
  }
  known.t_s.conservativeResize(count);
  known.values.conservativeResize(count);
  const Index steps = count - 1;
  if (steps < 1) return known;
  VectorXd step = known.t_s.tail(steps) - known.t_s.head(steps);
  double* const middle = step.data() + steps / 2;
  std::nth_element(step.data(), middle, step.data() + steps);
  const double longest = most_gap * *middle;
  for (Index i = 0; i < steps; ++i) {
    if (known.t_s[i + 1] - known.t_s[i] > longest)
      known.gaps.push_back({known.t_s[i], known.t_s[i + 1]});
  }
  return known;
}

// Of the gaps of a file, within the time that is shared.
void remark_gaps(const NamedColumns& columns, const VectorXd& t_s, const Span& shared,
                 double most_gap, std::vector<std::string>& remarks) {
  std::vector<Span> gaps = known_of(t_s, t_s, most_gap).gaps;
  std::erase_if(
      gaps, [&](const Span& gap) { return gap.last <= shared.first || gap.first >= shared.last; });
  if (gaps.empty()) return;
  const Index row = std::lower_bound(t_s.begin(), t_s.end(), gaps[0].first) - t_s.begin();
  remarks.push_back(
      fmt::format("{} has {} gap{}, the first of {:.4g} s behind {}: no rows are taken there",
                  columns.file, gaps.size(), gaps.size() == 1 ? "" : "s",
                  gaps[0].last - gaps[0].first, columns.place_of(row)));
}

// NaN in a gap and beyond what the file has. A straight line through the jump of an angle would be
// neither before nor behind it.
VectorXd values_at(Known known, const VectorXd& at_s, const std::string& name,
                   std::vector<std::string>& remarks) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  VectorXd result = VectorXd::Constant(at_s.size(), kNone);
  if (known.t_s.size() < 2) return result;
  const KnownFold fold = known_fold_in_any_unit(known.values);
  if (!fold.folds.empty()) {
    unfold(known.values, fold.range, fold.folds);
    remarks.push_back(
        fmt::format("{} is folded into a range of {:.4g}, {} times: unfolded before it was joined",
                    name, fold.range, fold.folds.size()));
  }
  const double last_s = known.t_s[known.t_s.size() - 1];
  const Index begin = std::lower_bound(at_s.begin(), at_s.end(), known.t_s[0]) - at_s.begin();
  const Index end = std::upper_bound(at_s.begin(), at_s.end(), last_s) - at_s.begin();
  if (end <= begin) return result;
  result.segment(begin, end - begin) =
      linear_at(known.t_s, known.values, at_s.segment(begin, end - begin));
  for (const Span& gap : known.gaps) {
    const Index from = std::upper_bound(at_s.begin(), at_s.end(), gap.first) - at_s.begin();
    const Index to = std::lower_bound(at_s.begin(), at_s.end(), gap.last) - at_s.begin();
    if (to > from) result.segment(from, to - from).setConstant(kNone);
  }
  return result;
}

double length_of(const FileTime& time) { return time.t_s[time.t_s.size() - 1] - time.t_s[0]; }

// [channels] with the times of all files as they were read, but for the unit of one, where there is
// one, or the offset of the last, which is left open.
std::string time_line(const std::vector<TimedColumns>& files, std::size_t of, const char* unit) {
  ChannelMap map;
  for (const TimedColumns& file : files) {
    Channel& time = &file == files.data() ? map.time : map.more_times.emplace_back();
    time = file.time.channel;
    if (unit == nullptr && &file == &files.back()) time.offset = 0;
    if (unit != nullptr && &file == &files[of]) time.unit = unit;
  }
  std::string line = channel_lines(map, "time").front();
  if (unit == nullptr) line.insert(line.rfind('}'), ", offset = ... ");
  return "[channels] with " + line;
}

std::string mend_of_times(const std::vector<TimedColumns>& files) {
  for (std::size_t k = 1; k < files.size(); ++k) {
    for (const std::size_t longer : {k, std::size_t{0}}) {
      const std::size_t shorter = longer == 0 ? k : 0;
      const char* const unit = unit_by_length(files[longer].time, files[shorter].time);
      if (unit == nullptr) continue;
      return fmt::format(
          "say its unit: the time of {} lasts {:.4g} times as long as that of {}, as one in {} "
          "does: {}; where its clock counts from another zero, offset = ... beside it, in s",
          files[longer].columns.file,
          length_of(files[longer].time) / length_of(files[shorter].time),
          files[shorter].columns.file, unit, time_line(files, longer, unit));
    }
  }
  return fmt::format(
      "where the clocks differ, say by how much: {}, the offset of the last file in s",
      time_line(files, 0, nullptr));
}

// Names that one file alone has.
std::set<std::string> plain_names(const std::vector<const NamedColumns*>& files) {
  std::set<std::string> once;
  std::set<std::string> twice;
  for (const NamedColumns* file : files) {
    const auto count = [&](const auto& values) {
      for (const auto& [name, value] : values) {
        if (!once.insert(name).second) twice.insert(name);
      }
    };
    count(file->columns);
    count(file->scalars);
  }
  for (const std::string& name : twice) once.erase(name);
  return once;
}

// Puts what file `k` says of a column under the names that it has among all of them.
class Names {
 public:
  explicit Names(const std::vector<const NamedColumns*>& files) : plain_(plain_names(files)) {}

  [[nodiscard]] std::string of(std::size_t k, const std::string& name) const {
    return plain_.contains(name) ? name : name_in_file(k, name);
  }
  void put(std::size_t k, auto& to, const std::string& name, const auto& value) const {
    to[name_in_file(k, name)] = value;
    if (plain_.contains(name)) to[name] = value;
  }
  // All but the values of the columns.
  void put_words(std::size_t k, const NamedColumns& from, NamedColumns& into) const {
    into.has_names = into.has_names && from.has_names;
    into.remarks.insert(into.remarks.end(), from.remarks.begin(), from.remarks.end());
    for (const std::string& name : from.names) into.names.push_back(of(k, name));
    for (const std::string& name : from.taken) into.taken.insert(of(k, name));
    for (const auto& [name, unit] : from.units) put(k, into.units, name, unit);
    for (const auto& [name, value] : from.scalars) put(k, into.scalars, name, value);
  }

 private:
  std::set<std::string> plain_;
};

}  // namespace

const char* unit_by_length(const FileTime& time, const FileTime& other) {
  constexpr double kNear = 2;
  constexpr double kNearSteps = 4;
  const auto says_unit = [](const FileTime& one) {
    return !one.channel.unit.empty() || one.channel.scale != 1 || !one.channel.sum.empty() ||
           !one.channel.scale_source.empty();
  };
  if (says_unit(time) || time.t_s.size() < 2 || other.t_s.size() < 2) return nullptr;
  const auto is_near = [](double ratio, double wanted, double factor) {
    return ratio > wanted / factor && ratio < wanted * factor;
  };
  const double ratio = length_of(time) / length_of(other);
  const double of_steps =
      ratio * static_cast<double>(other.t_s.size() - 1) / static_cast<double>(time.t_s.size() - 1);
  for (const char* unit : kShortTimeUnits) {
    const double wanted = 1 / unit_factor(unit);
    if (is_near(ratio, wanted, kNear) && is_near(of_steps, wanted, kNearSteps)) return unit;
  }
  return nullptr;
}

TimedColumns joined_files(std::vector<TimedColumns> files, Index fewest, double most_gap) {
  TimedColumns& base = files.front();
  const double origin_s = base.time.origin_s;
  Span shared{base.time.t_s[0], base.time.t_s[base.time.t_s.size() - 1]};
  std::vector<Span> spans;
  for (TimedColumns& file : files) {
    check_length(file);
    file.time.t_s.array() += file.time.origin_s - origin_s;
    const VectorXd& t_s = file.time.t_s;
    spans.push_back({t_s[0], t_s[t_s.size() - 1]});
    shared.first = std::max(shared.first, spans.back().first);
    shared.last = std::min(shared.last, spans.back().last);
  }
  const VectorXd& clock = base.time.t_s;
  const Index begin = std::lower_bound(clock.begin(), clock.end(), shared.first) - clock.begin();
  const Index end = std::upper_bound(clock.begin(), clock.end(), shared.last) - clock.begin();
  if (end - begin < fewest) {
    std::vector<std::string> words;
    for (std::size_t k = 0; k < files.size(); ++k) {
      words.push_back(fmt::format("{:.9g} to {:.9g} s in {}", spans[k].first + origin_s,
                                  spans[k].last + origin_s, files[k].columns.file));
    }
    fail(base.columns.file, "",
         "times of which too few samples lie in every file: " + list_of(words),
         fmt::format("{} samples or more within each other's time", fewest), mend_of_times(files));
  }
  std::vector<const NamedColumns*> all;
  for (const TimedColumns& file : files) all.push_back(&file.columns);
  const Names names(all);  // without those of the times
  TimedColumns joined;
  NamedColumns& into = joined.columns;
  into.file = list_of(files, [](const TimedColumns& file) { return file.columns.file; });
  joined.time.origin_s = origin_s;
  joined.time.t_s = clock.segment(begin, end - begin);
  if (!base.time.rows.empty()) {
    joined.time.rows.assign(base.time.rows.begin() + begin, base.time.rows.begin() + end);
  }
  into.remarks.push_back(fmt::format(
      "{} files joined on the samples of {}: {} of its {}, from {} to {} s; the others by "
      "straight lines between theirs",
      files.size(), base.columns.file, end - begin, clock.size(), words_of_time(joined.time.t_s[0]),
      words_of_time(joined.time.t_s[end - begin - 1])));
  into.place_of = [place_of = base.columns.place_of, begin](Index row) {
    return place_of(row + begin);
  };
  for (std::size_t k = 0; k < files.size(); ++k) {
    NamedColumns& from = files[k].columns;
    if (k > 0) remark_gaps(from, files[k].time.t_s, shared, most_gap, into.remarks);
    names.put_words(k, from, into);
    for (auto& [name, values] : from.columns) {
      const VectorXd at = k == 0
                              ? VectorXd(values.segment(begin, end - begin))
                              : values_at(known_of(files[k].time.t_s, values, most_gap),
                                          joined.time.t_s, from.file + ": " + name, into.remarks);
      names.put(k, into.columns, name, at);
      values.resize(0);
    }
  }
  return joined;
}

NamedColumns named_together(const std::vector<const NamedColumns*>& files) {
  const Names names(files);
  NamedColumns together;
  together.file = list_of(files, [](const NamedColumns* file) { return file->file; });
  for (std::size_t k = 0; k < files.size(); ++k) {
    names.put_words(k, *files[k], together);
    for (const auto& column : files[k]->columns) {
      names.put(k, together.columns, column.first, VectorXd());
    }
  }
  return together;
}

}  // namespace offnominal::desk
