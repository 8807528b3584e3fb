#include "log/dbc.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <regex>

#include "common/error.hpp"
#include "common/file.hpp"

namespace offnominal::desk {
namespace {

constexpr std::uint32_t kExtendedBit = 0x80000000U;

// The bits of a signal, most significant first, as indices of byte * 8 + bit.
template <typename Use>
void for_each_bit(const DbcSignal& signal, Use&& use) {
  if (signal.little_endian) {
    for (int bit = signal.start_bit + signal.length - 1; bit >= signal.start_bit; --bit) use(bit);
    return;
  }
  int bit = signal.start_bit;
  for (int i = 0; i < signal.length; ++i) {
    use(bit);
    bit = bit % 8 == 0 ? bit + 15 : bit - 1;
  }
}

class DbcParser {
 public:
  DbcParser(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  Dbc parse() {
    while (!text_.empty()) {
      const std::size_t end = text_.find('\n');
      std::string line(text_.substr(0, end));
      text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
      ++line_;
      if (!line.empty() && line.back() == '\r') line.pop_back();
      read(line);
    }
    return std::move(dbc_);
  }

 private:
  [[noreturn]] void fail(const std::string& found, const std::string& allowed) const {
    throw InputError({file_, "line " + std::to_string(line_), found, allowed, "correct the line"});
  }

  void read(const std::string& line) {
    static const std::regex start(R"(^\s*(BO_|SG_|SIG_VALTYPE_)\s+\S.*)");
    std::smatch match;
    if (!std::regex_match(line, match, start)) return;
    if (match[1] == "BO_") {
      read_message(line);
    } else if (match[1] == "SG_") {
      read_signal(line);
    } else {
      read_value_type(line);
    }
  }

  void read_message(const std::string& line) {
    static const std::regex form(R"(^\s*BO_\s+(\d{1,10})\s+(\w+)\s*:\s*(\d{1,4})\s+\S+\s*$)");
    std::smatch match;
    if (!std::regex_match(line, match, form)) {
      fail("a message that cannot be read", "BO_ <id> <name>: <length> <sender>");
    }
    const std::uint64_t id = std::stoull(match[1]);
    DbcMessage message;
    message.extended = (id & kExtendedBit) != 0;
    message.id = static_cast<std::uint32_t>(id & ~std::uint64_t{kExtendedBit});
    message.name = match[2];
    message.length = std::stoi(match[3]);
    // Vector's file formats keep signals of no message under this one.
    const bool is_pool = message.name == "VECTOR__INDEPENDENT_SIG_MSG";
    if (!is_pool && message.length > 64) fail("a length of " + match[3].str(), "0 to 64 bytes");
    dbc_.messages.push_back(std::move(message));
  }

  void read_signal(const std::string& line) {
    static const std::regex form(
        R"(^\s*SG_\s+(\w+)\s*(M|m\d+M?)?\s*:\s*(\d{1,3})\|(\d{1,2})@([01])([+-])\s*\(([^,()]+),([^,()]+)\)\s*\[[^\]]*\]\s*"([^"]*)\".*$)");
    std::smatch match;
    if (!std::regex_match(line, match, form)) {
      fail("a signal that cannot be read",
           "SG_ <name> : <start>|<bits>@<order><sign> (<scale>,<offset>) [<least>|<most>] "
           "\"<unit>\"");
    }
    if (dbc_.messages.empty()) fail("a signal of no message", "a BO_ line before it");
    if (match[2].matched && match[2] != "M") return;
    DbcSignal signal;
    signal.name = match[1];
    signal.start_bit = std::stoi(match[3]);
    signal.length = std::stoi(match[4]);
    signal.little_endian = match[5] == "1";
    signal.is_signed = match[6] == "-";
    signal.scale = number(match[7]);
    signal.offset = number(match[8]);
    signal.unit = match[9];
    DbcMessage& message = dbc_.messages.back();
    if (signal.length < 1 || signal.length > 64) fail("a signal of no or over 64 bits", "1 to 64");
    if (!signal.fits(static_cast<std::size_t>(message.length)) &&
        message.name != "VECTOR__INDEPENDENT_SIG_MSG") {
      fail("a signal beyond the end of its message",
           "bits within its " + std::to_string(message.length) + " bytes");
    }
    message.signals.push_back(std::move(signal));
  }

  double number(const std::string& text) const {
    try {
      std::size_t used = 0;
      const double value = std::stod(text, &used);
      if (text.find_first_not_of(" \t", used) == std::string::npos) return value;
    } catch (const std::logic_error&) {
    }
    fail("\"" + text + "\"", "a number");
  }

  void read_value_type(const std::string& line) {
    static const std::regex form(R"(^\s*SIG_VALTYPE_\s+(\d{1,10})\s+(\w+)\s*:?\s*([0-3])\s*;\s*$)");
    std::smatch match;
    if (!std::regex_match(line, match, form)) {
      fail("a type that cannot be read", "SIG_VALTYPE_ <id> <signal> : <type>;");
    }
    const std::uint64_t id = std::stoull(match[1]);
    for (DbcMessage& message : dbc_.messages) {
      const std::uint64_t own = message.id | (message.extended ? kExtendedBit : 0U);
      if (own != id) continue;
      for (DbcSignal& signal : message.signals) {
        if (signal.name != match[2]) continue;
        const int bits = match[3] == "1" ? 32 : 64;
        signal.is_float = match[3] == "1" || match[3] == "2";
        if (signal.is_float && signal.length != bits) {
          fail("a float of " + std::to_string(signal.length) + " bits", std::to_string(bits));
        }
      }
    }
  }

  std::string_view text_;
  std::string file_;
  int line_ = 0;
  Dbc dbc_;
};

}  // namespace

bool DbcSignal::fits(std::size_t bytes) const {
  bool inside = true;
  for_each_bit(*this, [&](int bit) {
    inside = inside && bit >= 0 && static_cast<std::size_t>(bit) < 8 * bytes;
  });
  return inside;
}

double DbcSignal::value_in(std::span<const std::uint8_t> bytes) const {
  std::uint64_t bits = 0;
  for_each_bit(*this, [&](int bit) {
    const unsigned byte = bytes[static_cast<std::size_t>(bit / 8)];
    bits = (bits << 1U) | ((byte >> static_cast<unsigned>(bit % 8)) & 1U);
  });
  double raw = 0;
  if (is_float) {
    raw = length == 32 ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)))
                       : std::bit_cast<double>(bits);
  } else if (is_signed) {
    const auto unused = static_cast<unsigned>(64 - length);
    raw = static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
  } else {
    raw = static_cast<double>(bits);
  }
  return scale * raw + offset;
}

const DbcMessage* Dbc::find(std::uint32_t id, bool extended) const {
  const auto found = std::find_if(messages.begin(), messages.end(), [&](const DbcMessage& message) {
    return message.id == id && message.extended == extended;
  });
  return found == messages.end() ? nullptr : &*found;
}

Dbc parse_dbc(std::string_view text, const std::string& file) {
  return DbcParser(text, file).parse();
}

Dbc read_dbc(const std::filesystem::path& path) {
  keep_as_it_is(path);
  return parse_dbc(read_text_file(path), path.string());
}

}  // namespace offnominal::desk
