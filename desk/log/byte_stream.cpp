#include "log/byte_stream.hpp"

#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <system_error>
#include <utility>

namespace offnominal::desk {
namespace {

class FileBytes final : public ByteStream {
 public:
  explicit FileBytes(int file) : file_(file) {}
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;
  ~FileBytes() override { ::close(file_); }

  std::size_t read(char* to, std::size_t size) override {
    for (;;) {
      const ssize_t count = ::read(file_, to, size);
      if (count >= 0) return static_cast<std::size_t>(count);
      if (errno == EINTR) continue;
      throw StreamError(
          "a file that cannot be read (" + std::generic_category().message(errno) + ")", "");
    }
  }

 private:
  int file_;
};

// A stream whose first bytes may be looked at before they are read.
class PeekedBytes final : public ByteStream {
 public:
  explicit PeekedBytes(std::unique_ptr<ByteStream> rest) : rest_(std::move(rest)) {}

  // The first `size` bytes, fewer where there are no more.
  std::string_view peek(std::size_t size) {
    // A pipe gives less than was asked for, and more later.
    while (ahead_.size() < size) {
      std::array<char, 16> some{};
      const std::size_t count = rest_->read(some.data(), std::min(size, some.size()));
      if (count == 0) break;
      ahead_.append(some.data(), count);
    }
    return ahead_;
  }

  std::size_t read(char* to, std::size_t size) override {
    if (used_ == ahead_.size()) return rest_->read(to, size);
    const std::size_t count = std::min(size, ahead_.size() - used_);
    std::memcpy(to, ahead_.data() + used_, count);
    used_ += count;
    return count;
  }

 private:
  std::unique_ptr<ByteStream> rest_;
  std::string ahead_;
  std::size_t used_ = 0;
};

class UnpackedBytes final : public ByteStream {
 public:
  explicit UnpackedBytes(std::unique_ptr<ByteStream> packed) : packed_(std::move(packed)) {
    if (inflateInit2(&stream_, kGzip) != Z_OK) throw std::bad_alloc();
  }
  UnpackedBytes(const UnpackedBytes&) = delete;
  UnpackedBytes& operator=(const UnpackedBytes&) = delete;
  ~UnpackedBytes() override { inflateEnd(&stream_); }

  std::size_t read(char* to, std::size_t size) override {
    stream_.next_out = reinterpret_cast<Bytef*>(to);
    stream_.avail_out = static_cast<uInt>(std::min<std::size_t>(size, kMost));
    const uInt wanted = stream_.avail_out;
    while (stream_.avail_out == wanted) {
      if (stream_.avail_in == 0 && !refill()) return 0;
      // Another member behind the one before.
      if (between_) inflateReset2(&stream_, kGzip);
      between_ = false;
      const int state = inflate(&stream_, Z_NO_FLUSH);
      between_ = state == Z_STREAM_END;
      if (state != Z_OK && state != Z_STREAM_END) {
        throw StreamError("packed data that are damaged", kMend);
      }
    }
    return wanted - stream_.avail_out;
  }

 private:
  static constexpr int kGzip = 15 + 16;  // the largest window, gzip's header
  static constexpr std::size_t kMost = std::size_t{1} << 30;
  static constexpr const char* kMend =
      "take a whole copy of it; gzip -dc FILE > ... writes what can be unpacked";

  // False at the end, where one may be.
  bool refill() {
    const std::size_t count = packed_->read(chunk_.data(), chunk_.size());
    if (count == 0 && !between_) throw StreamError("packed data that end early", kMend);
    stream_.next_in = reinterpret_cast<Bytef*>(chunk_.data());
    stream_.avail_in = static_cast<uInt>(count);
    return count > 0;
  }

  std::unique_ptr<ByteStream> packed_;
  z_stream stream_{};
  bool between_ = false;  // two members
  std::array<char, 65536> chunk_{};
};

// UTF-16 as UTF-8; its byte order mark is left out.
class Utf8Bytes final : public ByteStream {
 public:
  Utf8Bytes(std::unique_ptr<ByteStream> wide, bool big_endian)
      : wide_(std::move(wide)), big_endian_(big_endian) {}

  std::size_t read(char* to, std::size_t size) override {
    while (used_ == ready_.size()) {
      ready_.clear();
      used_ = 0;
      if (!refill()) return 0;
    }
    const std::size_t count = std::min(size, ready_.size() - used_);
    std::memcpy(to, ready_.data() + used_, count);
    used_ += count;
    return count;
  }

 private:
  static constexpr const char* kMend = "save it as text in UTF-8";
  static constexpr std::uint32_t kMark = 0xFEFF;

  bool refill() {
    std::array<char, 65536> chunk{};
    const std::size_t count = wide_->read(chunk.data() + odd_, chunk.size() - odd_);
    chunk[0] = odd_ > 0 ? left_ : chunk[0];
    if (count == 0) {
      if (odd_ > 0 || high_ != 0) throw StreamError("half a letter of UTF-16 at its end", kMend);
      return false;
    }
    const std::size_t bytes = count + odd_;
    for (std::size_t i = 0; i + 1 < bytes; i += 2) {
      const std::uint32_t first = static_cast<std::uint8_t>(chunk[i]);
      const std::uint32_t second = static_cast<std::uint8_t>(chunk[i + 1]);
      take(big_endian_ ? first << 8U | second : second << 8U | first);
    }
    odd_ = bytes % 2;
    left_ = chunk[bytes - 1];
    return true;
  }

  void take(std::uint32_t unit) {
    const bool is_high = unit >= 0xD800 && unit < 0xDC00;
    const bool is_low = unit >= 0xDC00 && unit < 0xE000;
    if (is_low != (high_ != 0)) throw StreamError("letters that are no UTF-16", kMend);
    if (is_high) {
      high_ = unit;
      return;
    }
    std::uint32_t letter = unit;
    if (is_low) letter = 0x10000 + ((high_ - 0xD800) << 10U) + (unit - 0xDC00);
    high_ = 0;
    const bool is_mark = begins_ && letter == kMark;
    begins_ = false;
    if (!is_mark) append(letter);
  }

  void append(std::uint32_t letter) {
    const auto tail = [&](unsigned shift) {
      ready_ += static_cast<char>(0x80U | (letter >> shift & 0x3FU));
    };
    if (letter < 0x80) {
      ready_ += static_cast<char>(letter);
    } else if (letter < 0x800) {
      ready_ += static_cast<char>(0xC0U | letter >> 6U);
      tail(0);
    } else if (letter < 0x10000) {
      ready_ += static_cast<char>(0xE0U | letter >> 12U);
      tail(6);
      tail(0);
    } else {
      ready_ += static_cast<char>(0xF0U | letter >> 18U);
      tail(12);
      tail(6);
      tail(0);
    }
  }

  std::unique_ptr<ByteStream> wide_;
  bool big_endian_;
  bool begins_ = true;
  std::uint32_t high_ = 0;  // first half of a letter beyond 16 bits; 0: none
  std::size_t odd_ = 0;     // 1: `left_` is the first byte of the next unit
  char left_ = 0;
  std::string ready_;
  std::size_t used_ = 0;
};

}  // namespace

std::unique_ptr<ByteStream> stream_of(int file) { return std::make_unique<FileBytes>(file); }

std::unique_ptr<ByteStream> plain_stream(std::unique_ptr<ByteStream> stored, bool& is_as_stored) {
  is_as_stored = true;
  auto peeked = std::make_unique<PeekedBytes>(std::move(stored));
  if (peeked->peek(2).starts_with("\x1f\x8b")) {
    is_as_stored = false;
    peeked = std::make_unique<PeekedBytes>(std::make_unique<UnpackedBytes>(std::move(peeked)));
  }
  const std::string_view begin = peeked->peek(2);
  const bool little = begin.starts_with("\xFF\xFE");
  if (!little && !begin.starts_with("\xFE\xFF")) return peeked;
  is_as_stored = false;
  return std::make_unique<Utf8Bytes>(std::move(peeked), !little);
}

}  // namespace offnominal::desk
