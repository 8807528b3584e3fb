#include "log/mat_claims.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <string_view>

namespace offnominal::desk {
namespace {

// Data types and array classes of the format that the walk meets.
constexpr std::uint32_t kInt8 = 1;
constexpr std::uint32_t kInt32 = 5;
constexpr std::uint32_t kUint32 = 6;
constexpr std::uint32_t kMatrix = 14;
constexpr std::uint32_t kPacked = 15;
constexpr std::uint32_t kCellClass = 1;
constexpr std::uint32_t kStructureClass = 2;
constexpr std::uint32_t kTextClass = 4;
constexpr std::uint32_t kFirstNumberClass = 6;
constexpr std::uint32_t kLastNumberClass = 15;
constexpr std::uint32_t kFunctionClass = 16;
constexpr std::uint32_t kOpaqueClass = 17;

constexpr std::uint64_t kHeaderSize = 128;
constexpr std::uint64_t kTagSize = 8;
// Deeper than anybody nests, and far from what a stack holds.
constexpr int kMostDeep = 64;

bool is_container(std::uint32_t array_class) {
  return array_class == kCellClass || array_class == kStructureClass ||
         array_class == kFunctionClass;
}

bool holds_numbers(std::uint32_t array_class) {
  return array_class >= kFirstNumberClass && array_class <= kLastNumberClass;
}

// What an element of an array takes at least; nothing where an array may claim more than it stores.
double least_size(std::uint32_t array_class) {
  if (is_container(array_class)) return static_cast<double>(kTagSize);
  return array_class == kTextClass || holds_numbers(array_class) ? 1 : 0;
}

// Bytes of one number of a data type; 0 for what is none.
int width_of(std::uint32_t type) {
  constexpr std::array<int, 14> kWidth{0, 1, 1, 2, 2, 4, 4, 4, 0, 8, 0, 0, 8, 8};
  return type < kWidth.size() ? kWidth[type] : 0;
}

const char* unit_of(std::uint32_t array_class) {
  switch (array_class) {
    case kCellClass:
      return "cells";
    case kStructureClass:
      return "fields";
    case kFunctionClass:
      return "function handles";
    default:
      return "values";
  }
}

// Bytes that are read once, from the first to the last.
class ByteSource {
 public:
  ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;
  virtual ~ByteSource() = default;
  // False where they end before.
  virtual bool read(char* to, std::size_t size) = 0;
};

class PlainBytes final : public ByteSource {
 public:
  explicit PlainBytes(std::ifstream& file) : file_(file) {}
  bool read(char* to, std::size_t size) override {
    return static_cast<bool>(file_.read(to, static_cast<std::streamsize>(size)));
  }

 private:
  std::ifstream& file_;
};

// Unpacks what begins where the file stands, `size` bytes of it.
class PackedBytes final : public ByteSource {
 public:
  PackedBytes(std::ifstream& file, std::uint64_t size) : file_(file), left_(size) {
    good_ = inflateInit(&stream_) == Z_OK;
  }
  ~PackedBytes() override { inflateEnd(&stream_); }
  PackedBytes(const PackedBytes&) = delete;
  PackedBytes& operator=(const PackedBytes&) = delete;

  bool read(char* to, std::size_t size) override {
    stream_.next_out = reinterpret_cast<Bytef*>(to);
    stream_.avail_out = static_cast<uInt>(size);
    while (good_ && stream_.avail_out > 0) {
      if (stream_.avail_in == 0 && !refill()) return false;
      const int state = inflate(&stream_, Z_NO_FLUSH);
      good_ = state == Z_OK;
      ended_ = state == Z_STREAM_END;
    }
    return stream_.avail_out == 0;
  }
  // Unpacks what is left: whether it ends as it should, with its checksum.
  bool ends_well() {
    std::array<char, 16384> scratch{};
    while (read(scratch.data(), scratch.size())) {
    }
    return ended_;
  }

 private:
  bool refill() {
    const std::uint64_t wanted = std::min<std::uint64_t>(left_, chunk_.size());
    file_.read(chunk_.data(), static_cast<std::streamsize>(wanted));
    const auto got = static_cast<std::uint64_t>(file_.gcount());
    left_ -= got;
    stream_.next_in = reinterpret_cast<Bytef*>(chunk_.data());
    stream_.avail_in = static_cast<uInt>(got);
    return got > 0;
  }

  std::ifstream& file_;
  std::uint64_t left_;
  z_stream stream_{};
  bool good_ = false;
  bool ended_ = false;
  std::array<char, 16384> chunk_{};
};

// What is wrong with a cell array, structure or function handle, on its way out of the walk.
struct Damage {
  std::string what;
};

struct Tag {
  std::uint32_t type;
  std::uint32_t size;
};

// Walks through one variable. `left` is everywhere what remains of the element that is read.
class VariableWalk {
 public:
  VariableWalk(ByteSource& bytes, bool big_endian) : bytes_(bytes), big_endian_(big_endian) {}

  // From its array flags on, as far as matio reads to find the next variable; of numbers also how
  // many are stored. Throws Damage.
  void variable(std::uint64_t left) {
    const Tag flags = tag(left);
    const std::uint32_t array_class = word(left) & 0xffU;
    word(left);  // what a sparse matrix holds at most
    if (is_container(array_class) && (flags.type == kUint32 || flags.type == kInt32)) {
      contents(array_class, left, 0);
    } else {
      const double elements = read_elements(left, array_class == kOpaqueClass);
      name_ = read_text(left);
      if (holds_numbers(array_class)) numbers(elements, left);
    }
  }

  const std::string& name() const { return name_; }
  Tag tag(std::uint64_t& left) {
    const std::uint32_t type = word(left);
    return {type, word(left)};
  }

 private:
  // An array in a container, up to its end.
  void array(std::uint64_t left, int depth) {
    const Tag flags = tag(left);
    const std::uint32_t array_class = word(left) & 0xffU;
    word(left);  // what a sparse matrix holds at most
    if (flags.type != kUint32) throw Damage{"an array without array flags"};
    if (array_class == kOpaqueClass) {
      skip(left, left);
    } else {
      contents(array_class, left, depth);
    }
  }

  void contents(std::uint32_t array_class, std::uint64_t left, int depth) {
    if (depth >= kMostDeep) throw Damage{fmt::format("more than {} levels", kMostDeep)};
    double elements = read_elements(left);
    const std::string name = read_text(left);
    if (depth == 0) name_ = name;
    if (array_class == kStructureClass) elements *= read_field_count(left);
    if (elements * least_size(array_class) > static_cast<double>(left)) {
      throw Damage{fmt::format("{:.0f} {} in {} bytes", elements, unit_of(array_class), left)};
    }
    if (is_container(array_class)) {
      for (auto i = static_cast<std::uint64_t>(elements); i > 0; --i) element(left, depth);
    } else if (holds_numbers(array_class)) {
      numbers(elements, left);
    }
    skip(left, left);
  }

  void element(std::uint64_t& left, int depth) {
    const Tag element = tag(left);
    if (element.size == 0) return;
    if (element.type != kMatrix) throw Damage{"an element that is no array"};
    if (element.size > left) {
      throw Damage{fmt::format("an element of {} bytes in {} bytes", element.size, left)};
    }
    left -= element.size;
    array(element.size, depth + 1);
  }

  // As many as the dimensions say: where there are fewer, matio says nothing, and what it has
  // allocated keeps what was in that memory before.
  void numbers(double elements, std::uint64_t& left) {
    if (elements == 0) return;
    const Tag data = tag(left);
    const bool is_small = data.type >> 16U != 0;  // in the tag itself
    const std::uint64_t size = is_small ? data.type >> 16U : data.size;
    const int width = width_of(data.type & 0xffffU);
    if (width == 0) throw Damage{"numbers of an unknown type"};
    if (elements * width != static_cast<double>(size) || (!is_small && size > left)) {
      const std::uint64_t there = is_small ? size : std::min(size, left);
      throw Damage{fmt::format("{:.0f} values in {} bytes", elements, there)};
    }
  }

  // An object has no dimensions where other arrays have theirs; matio looks there all the same.
  double read_elements(std::uint64_t& left, bool may_be_missing = false) {
    const Tag dimensions = tag(left);
    if (may_be_missing && dimensions.type != kInt32) return 0;
    if (dimensions.size > left) {
      throw Damage{fmt::format("{} dimensions in {} bytes", dimensions.size / 4, left)};
    }
    if (dimensions.type != kInt32 || dimensions.size % 4 != 0 || dimensions.size < 8) {
      throw Damage{"an array without dimensions"};
    }
    double elements = 1;  // saturates, where an integer would wrap
    for (std::uint32_t i = 0; i < dimensions.size / 4; ++i) elements *= word(left);
    skip(left, padding(dimensions.size));
    return elements;
  }

  // A name of a variable, or names of fields.
  std::string read_text(std::uint64_t& left) {
    const Tag text = tag(left);
    if (text.type != kInt8) {
      const std::uint32_t size = std::min<std::uint32_t>(text.type >> 16U, 4);
      std::string packed;
      for (std::uint32_t i = 0; i < size; ++i) {
        packed += static_cast<char>(text.size >> (big_endian_ ? 24 - 8 * i : 8 * i));
      }
      return packed;
    }
    if (text.size > left) throw Damage{fmt::format("a name of {} bytes", text.size)};
    std::string value(text.size, '\0');
    take(left, value.data(), value.size());
    skip(left, padding(text.size));
    return value;
  }

  double read_field_count(std::uint64_t& left) {
    const Tag name_size = tag(left);
    if ((name_size.type & 0xffffU) != kInt32 || name_size.size == 0) {
      throw Damage{"no size of field names"};
    }
    const std::size_t count = read_text(left).size() / name_size.size;
    return static_cast<double>(count);
  }

  static std::uint64_t padding(std::uint64_t size) { return (8 - size % 8) % 8; }

  std::uint32_t word(std::uint64_t& left) {
    std::array<char, 4> raw{};
    take(left, raw.data(), raw.size());
    if (big_endian_) std::reverse(raw.begin(), raw.end());
    std::uint32_t value = 0;
    for (std::size_t i = raw.size(); i-- > 0;)
      value = value << 8U | static_cast<std::uint8_t>(raw[i]);
    return value;
  }

  void skip(std::uint64_t& left, std::uint64_t size) {
    std::array<char, 4096> scratch{};
    while (size > 0) {
      const std::uint64_t part = std::min<std::uint64_t>(size, scratch.size());
      take(left, scratch.data(), part);
      size -= part;
    }
  }

  void take(std::uint64_t& left, char* to, std::uint64_t size) {
    if (size > left || !bytes_.read(to, size)) throw Damage{"an end before all is there"};
    left -= size;
  }

  ByteSource& bytes_;
  bool big_endian_;
  std::string name_;
};

// What is wrong in the variable that begins where the file stands, its own tag behind it.
std::optional<ImpossibleClaim> claim_in(std::ifstream& file, const Tag& element,
                                        std::uint64_t file_left, bool big_endian) {
  const std::uint64_t stored = std::min<std::uint64_t>(element.size, file_left);
  const bool is_whole = element.size <= file_left;
  PlainBytes plain(file);
  PackedBytes packed(file, stored);
  const bool is_packed = element.type == kPacked;
  VariableWalk walk(is_packed ? static_cast<ByteSource&>(packed) : plain, big_endian);
  try {
    std::uint64_t size = stored;
    if (is_packed) {
      std::uint64_t left = kTagSize;
      const Tag array = walk.tag(left);
      if (array.type != kMatrix) throw Damage{"packed data that is no array"};
      size = std::min<std::uint64_t>(array.size, kMostPerPackedByte * stored);
    }
    walk.variable(size);
    if (!is_whole) {
      throw Damage{fmt::format("a variable of {} bytes in {} bytes", element.size, file_left)};
    }
    if (is_packed && !packed.ends_well()) throw Damage{"packed data that are damaged"};
  } catch (const Damage& damage) {
    return ImpossibleClaim{walk.name(), damage.what};
  }
  return std::nullopt;
}

struct Header {
  int version;  // 1 at level 5, 2 at level 7.3
  bool big_endian;
};

std::optional<Header> header_in(std::string_view beginning) {
  if (beginning.size() < kHeaderSize) return std::nullopt;
  const std::string_view order = beginning.substr(126, 2);
  if (order != "IM" && order != "MI") return std::nullopt;
  const bool big_endian = order == "MI";
  return Header{beginning[big_endian ? 124 : 125], big_endian};
}

std::optional<Header> read_header(std::ifstream& file) {
  std::array<char, kHeaderSize> header{};
  if (!file.read(header.data(), header.size())) return std::nullopt;
  return header_in({header.data(), header.size()});
}

}  // namespace

bool is_mat_level_5_or_7(std::string_view beginning) {
  const auto header = header_in(beginning);
  return header && (header->version == 1 || header->version == 2);
}

std::optional<ImpossibleClaim> impossible_claim(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const auto header = read_header(file);
  if (!header || header->version != 1) return std::nullopt;
  const std::uint64_t end = std::filesystem::file_size(path);
  for (std::uint64_t at = kHeaderSize; at < end;) {
    if (end - at < kTagSize) {
      return ImpossibleClaim{"", fmt::format("{} bytes where a variable begins", end - at)};
    }
    file.clear();
    file.seekg(static_cast<std::streamoff>(at));
    PlainBytes plain(file);
    std::uint64_t left = kTagSize;
    const Tag element = VariableWalk(plain, header->big_endian).tag(left);
    at += kTagSize;
    // matio goes no further than to something else, and says nothing.
    if (element.type != kPacked && element.type != kMatrix) return std::nullopt;
    if (auto claim = claim_in(file, element, end - at, header->big_endian)) return claim;
    at += element.size;
  }
  return std::nullopt;
}

}  // namespace offnominal::desk
