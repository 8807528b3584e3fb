#pragma once

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

namespace offnominal::desk {

// Bytes that are read once, from the first to the last.
class ByteStream {
 public:
  ByteStream() = default;
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;
  virtual ~ByteStream() = default;

  // As many bytes as there are at once, up to `size`, at least 1; 0 at the end. Throws StreamError.
  virtual std::size_t read(char* to, std::size_t size) = 0;
};

// What keeps a stream from being read, in words: found, and how to mend it.
struct StreamError : std::runtime_error {
  StreamError(const std::string& found, std::string how)
      : std::runtime_error(found), mend(std::move(how)) {}
  std::string mend;
};

// Of a file descriptor, which it closes.
[[nodiscard]] std::unique_ptr<ByteStream> stream_of(int file);

// What the bytes are when they are unpacked (gzip, one member or several) and in UTF-8 (from UTF-16
// with its byte order mark), as their first bytes tell; `is_as_stored` becomes false where they are
// either. A byte order mark of UTF-8 stays.
[[nodiscard]] std::unique_ptr<ByteStream> plain_stream(std::unique_ptr<ByteStream> stored,
                                                       bool& is_as_stored);

}  // namespace offnominal::desk
