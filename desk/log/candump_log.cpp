#include "log/candump_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <offnominal/hal/messages.hpp>
#include <offnominal/hal/protocols/protected/address.hpp>

#include "common/error.hpp"
#include "log/dbc.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

// "181#2A366C" and its kin; false for another form.
bool parse_frame(std::string_view text, hal::Frame& frame) {
  const std::size_t mark = text.find('#');
  if (mark != 3 && mark != 8) return false;
  frame.extended = mark == 8;
  const auto id = std::from_chars(text.data(), text.data() + mark, frame.id, 16);
  if (id.ec != std::errc() || id.ptr != text.data() + mark) return false;
  text.remove_prefix(mark + 1);
  if (!text.empty() && text[0] == '#') {
    frame.fd = true;
    if (text.size() < 2 || hex_digit(text[1]) < 0) return false;
    text.remove_prefix(2);
  } else if (!text.empty() && text[0] == 'R') {
    frame.remote = true;
    const int length = text.size() < 2 ? 0 : hex_digit(text[1]);
    if (length < 0 || text.size() > 2) return false;
    frame.length = static_cast<std::uint8_t>(length);
    return is_well_formed(frame);
  }
  if (text.size() % 2 != 0 || text.size() > 2U * hal::kMaxFdLength) return false;
  for (std::size_t i = 0; i < text.size() / 2; ++i) {
    const int high = hex_digit(text[2 * i]);
    const int low = hex_digit(text[2 * i + 1]);
    if (high < 0 || low < 0) return false;
    frame.data[i] = static_cast<std::uint8_t>(16 * high + low);
  }
  frame.length = static_cast<std::uint8_t>(text.size() / 2);
  return is_well_formed(frame);
}

// The values that one signal has had.
struct Track {
  std::string name;
  std::string interface;
  std::vector<double> t_s;
  std::vector<double> value;
  std::vector<std::size_t> line;
};

// q1, dq1 and tau1 of offnominal's own signals; empty for others.
std::string common_name(const std::string& message, const std::string& signal) {
  const auto joint_of = [](const std::string& text, const std::string& prefix) {
    const bool begins = text.starts_with(prefix) && text.size() == prefix.size() + 1;
    return begins ? std::string(1, text.back()) : std::string();
  };
  std::string joint;
  std::string quantity;
  if (message == "encoder_group" || message == "drive_status_group") {
    const std::size_t end = signal.find('_');
    if (end != 2 || signal[0] != 'j') return {};
    joint = signal[1];
    quantity = signal.substr(3);
  } else {
    joint = joint_of(message, "encoder_") + joint_of(message, "drive_status_");
    quantity = signal;
  }
  if (joint.empty()) return {};
  if (quantity == "position") return "q" + joint;
  if (quantity == "velocity") return "dq" + joint;
  if (quantity == "applied_torque") return "tau" + joint;
  return {};
}

class CandumpReader {
 public:
  CandumpReader(std::string file, const Dbc& dbc, const NeedOf& need_of)
      : file_(std::move(file)), dbc_(dbc) {
    for (const DbcMessage& message : dbc_.messages) {
      const bool own = is_own(message);
      for (const DbcSignal& signal : message.signals) {
        std::string name = own ? common_name(message.name, signal.name) : std::string();
        if (name.empty() || !is_required(need_of(name))) {
          name = message.name + "." + signal.name;
          if (!is_required(need_of(name))) continue;
        }
        wanted_.push_back({&message, &signal, tracks_.size(), own});
        tracks_.push_back({name, {}, {}, {}, {}});
      }
    }
  }

  NamedColumns read(RecordingFile& file) {
    each_candump_frame(file,
                       [&](const CandumpFrame& frame, std::size_t line) { take(frame, line); });
    return columns();
  }

 private:
  struct Wanted {
    const DbcMessage* message;
    const DbcSignal* signal;
    std::size_t track;
    bool own;
  };

  // Whether a message is one of offnominal's own, whichever file it is described in.
  static bool is_own(const DbcMessage& message) {
    const DbcMessage* own = offnominal_dbc().find(message.id, message.extended);
    return own != nullptr && *own == message;
  }

  void take(const CandumpFrame& frame, std::size_t line) {
    const DbcMessage* message = dbc_.find(frame.frame.id, frame.frame.extended);
    if (message == nullptr || frame.frame.remote) return;
    for (const Wanted& wanted : wanted_) {
      if (wanted.message != message || !wanted.signal->fits(frame.frame.length)) continue;
      if (wanted.own && !is_told(frame.frame, *wanted.signal)) continue;
      Track& track = tracks_[wanted.track];
      if (!is_next(track, frame, line)) continue;
      track.t_s.push_back(frame.time_s);
      track.value.push_back(wanted.signal->value_in(
          std::span<const std::uint8_t>(frame.frame.data).first(frame.frame.length)));
      track.line.push_back(line);
      if (++numbers_ <= RecordingFile::kMostNumbers / kPerValue) continue;
      throw InputError({file_, fmt::format("line {}", line),
                        fmt::format("more than {} values", RecordingFile::kMostNumbers / kPerValue),
                        "a recording that ends", "cut it into parts"});
    }
  }

  // A second message in one tick, or two whose stamps were taken by two processors, is left out. A
  // clock that was set back and a second recording behind the first one would be left out whole,
  // and of two buses whoever comes first would be taken.
  bool is_next(Track& track, const CandumpFrame& frame, std::size_t line) const {
    constexpr double kMostBackS = 0.01;
    if (track.t_s.empty()) {
      track.interface = frame.interface;
      return true;
    }
    if (frame.interface != track.interface) {
      throw InputError(
          {file_, fmt::format("line {}", line),
           track.name + " on " + frame.interface + " and, before, on " + track.interface,
           "every signal on one interface",
           "keep the lines of one, as grep ' " + track.interface + " ' does"});
    }
    if (frame.time_s < track.t_s.back() - kMostBackS) {
      throw InputError({file_, fmt::format("line {}", line),
                        fmt::format("a time {:.6g} s before that of {} before it",
                                    track.t_s.back() - frame.time_s, track.name),
                        "times that ascend", "cut the recording there, into one for each run"});
    }
    return frame.time_s > track.t_s.back();
  }

  // Whether the record that the signal lies in opens, and tells it: drives that send positions
  // alone have a mark in the velocity's place.
  static bool is_told(const hal::Frame& frame, const DbcSignal& signal) {
    hal::Address address;
    if (address_of(frame, address) != hal::Status::kOk) return false;
    const auto index = static_cast<std::size_t>(signal.start_bit / 64);
    std::uint8_t counter = 0;
    const auto node = static_cast<std::uint8_t>(address.first_node + index);
    const std::uint16_t id = data_id_of(address.kind, node);
    const auto record = hal::record_in(frame, index);
    if (address.kind == hal::MessageKind::kEncoder && signal.name.ends_with("velocity")) {
      hal::EncoderReading reading;
      return decode(record, id, reading, counter) == hal::Status::kOk && reading.has_velocity;
    }
    hal::Content content{};
    return hal::open(record, id, content, counter) == hal::Status::kOk;
  }

  NamedColumns columns() {
    std::erase_if(tracks_, [](const Track& track) { return track.t_s.empty(); });
    NamedColumns columns;
    columns.file = file_;
    if (tracks_.empty()) {
      throw InputError({file_, "", "no frame that holds a signal which is needed",
                        "frames of the DBC file, intact",
                        "look at the identifiers; name another DBC file with [channels] dbc"});
    }
    const Track& base = *std::min_element(
        tracks_.begin(), tracks_.end(),
        [](const Track& a, const Track& b) { return a.line.front() < b.line.front(); });
    const auto rows = static_cast<Index>(base.t_s.size());
    Eigen::VectorXd time = Eigen::Map<const Eigen::VectorXd>(base.t_s.data(), rows);
    // Time stamps of the epoch would cost digits.
    time.array() -= base.t_s.front();
    columns.names = {"t"};
    columns.columns["t"] = time;
    const double longest = kMostMissed * median_step(base);
    for (const Track& track : tracks_) {
      columns.names.push_back(track.name);
      columns.columns[track.name] = nearest(track, base, longest);
    }
    columns.place_of = [lines = base.line](Index row) {
      return fmt::format("line {}", lines[static_cast<std::size_t>(row)]);
    };
    return columns;
  }

  static double median_step(const Track& track) {
    if (track.t_s.size() < 2) return 0;
    std::vector<double> steps;
    for (std::size_t i = 1; i < track.t_s.size(); ++i) {
      steps.push_back(track.t_s[i] - track.t_s[i - 1]);
    }
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return *middle;
  }

  Eigen::VectorXd nearest(const Track& track, const Track& base, double longest) const {
    Eigen::VectorXd values(static_cast<Index>(base.t_s.size()));
    std::size_t at = 0;
    for (std::size_t row = 0; row < base.t_s.size(); ++row) {
      const double t_s = base.t_s[row];
      while (at + 1 < track.t_s.size() &&
             std::fabs(track.t_s[at + 1] - t_s) <= std::fabs(track.t_s[at] - t_s)) {
        ++at;
      }
      if (std::fabs(track.t_s[at] - t_s) > longest) {
        throw InputError({file_, fmt::format("line {}, {}", base.line[row], track.name),
                          fmt::format("no value within {:.3g} s", longest),
                          "frames without a pause", "cut the recording at the pause"});
      }
      values[static_cast<Index>(row)] = track.value[at];
    }
    return values;
  }

  // Value, time and line are kept of each until all are there.
  static constexpr std::size_t kPerValue = 3;

  std::string file_;
  const Dbc& dbc_;
  std::size_t numbers_ = 0;
  std::vector<Wanted> wanted_;
  std::vector<Track> tracks_;
};

}  // namespace

std::optional<CandumpFrame> parse_candump_line(std::string_view line) {
  CandumpFrame result;
  const std::size_t close = line.find(')');
  if (!line.starts_with('(') || close == std::string_view::npos) return std::nullopt;
  const char* end = line.data() + close;
  const auto time = std::from_chars(line.data() + 1, end, result.time_s);
  if (time.ec != std::errc() || time.ptr != end || !std::isfinite(result.time_s)) {
    return std::nullopt;
  }
  std::string_view rest = line.substr(close + 1);
  if (!rest.starts_with(' ')) return std::nullopt;
  rest.remove_prefix(1);
  const std::size_t blank = rest.find(' ');
  if (blank == std::string_view::npos || blank == 0) return std::nullopt;
  result.interface = std::string(rest.substr(0, blank));
  rest.remove_prefix(blank + 1);
  // Newer versions append the direction.
  if (rest.ends_with(" R") || rest.ends_with(" T")) rest.remove_suffix(2);
  if (!parse_frame(rest, result.frame)) return std::nullopt;
  return result;
}

void each_candump_frame(RecordingFile& file,
                        const std::function<void(const CandumpFrame&, std::size_t line)>& take) {
  std::string content;
  // Of another form; the last line may be.
  std::optional<std::string> odd;
  std::size_t line = 0;
  while (file.next_line(content)) {
    if (odd) {
      throw InputError({file.name(), fmt::format("line {}", line), odd->substr(0, 60),
                        "a line of candump -l: (seconds) interface ID#DATA", ""});
    }
    ++line;
    if (content.ends_with('\r')) content.pop_back();
    if (content.empty()) continue;
    if (const auto frame = parse_candump_line(content)) {
      take(*frame, line);
    } else {
      odd = content;
    }
  }
}

bool is_candump_file(const RecordingFile& file) {
  const std::string_view beginning = file.beginning();
  std::string_view line = beginning.substr(0, beginning.find('\n'));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return parse_candump_line(line).has_value();
}

NamedColumns read_candump(RecordingFile& file, const ChannelMap* channels, const NeedOf& need_of) {
  if (channels == nullptr || channels->dbc.empty()) {
    return CandumpReader(file.name(), offnominal_dbc(), need_of).read(file);
  }
  const Dbc dbc = read_dbc(channels->dbc);
  return CandumpReader(file.name(), dbc, need_of).read(file);
}

}  // namespace offnominal::desk
