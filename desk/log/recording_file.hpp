#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>

#include "log/byte_stream.hpp"

namespace offnominal::desk {

// A recording as it comes: a file, a pipe, or standard input, which "-" names; packed (gzip) or in
// UTF-16 as well, which nobody behind this sees (byte_stream.hpp). It is opened once and read once,
// from its beginning. What has no end, or is no text, ends with an InputError and not with the
// machine's memory.
class RecordingFile {
 public:
  static constexpr std::size_t kBeginning = 512;                     // bytes
  static constexpr std::size_t kLongestLine = std::size_t{1} << 20;  // bytes
  static constexpr std::size_t kMostLines = std::size_t{8} << 30;    // bytes of them together
  static constexpr std::size_t kMostCopied = std::size_t{2} << 30;   // bytes
  // Of all columns together, 2 GB of memory: 10 million samples of seven joints and their time have
  // 220 million.
  static constexpr std::size_t kMostNumbers = 250'000'000;

  // Throws InputError where there is nothing to read: no such file, a folder, not readable.
  // `joined`: the recording that it is one file of, where that names several.
  explicit RecordingFile(const std::filesystem::path& path,
                         const std::filesystem::path& joined = {});
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;
  ~RecordingFile();

  // As messages and results name it.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  // The first bytes, at most kBeginning of them. Nothing is taken by it.
  [[nodiscard]] std::string_view beginning() const { return beginning_; }

  // The next line of a text without its end, valid until the next call; false where there is none.
  // Throws InputError for a line longer than kLongestLine, after kMostLines, and for bytes that no
  // text has.
  bool next_line(std::string_view& line);
  bool next_line(std::string& line);
  // Whether the line that came last was ended.
  [[nodiscard]] bool line_ended() const { return line_ended_; }

  // A path under which the whole of it can be opened, again and again, as long as this lives: its
  // own, or that of a copy where it is no regular file, or packed; at most kMostCopied. Before
  // anything else is read.
  std::filesystem::path seekable();

 private:
  [[nodiscard]] std::string line_place() const { return "line " + std::to_string(lines_ + 1); }
  [[noreturn]] void fail(const std::string& place, const std::string& found,
                         const std::string& allowed, const std::string& mend = {}) const;
  [[noreturn]] void refuse_copy(const std::error_code& error) const;
  [[noreturn]] void refuse_size(std::size_t most, const std::string& mend) const;
  // A file that has no name and goes with its last descriptor.
  [[nodiscard]] int nameless_file() const;
  bool fill();  // adds to the buffer; false at the end
  void copy_to(int file);

  std::filesystem::path path_;
  std::string name_;
  std::unique_ptr<ByteStream> stream_;
  bool is_as_stored_ = true;
  int copy_ = -1;
  std::string beginning_;
  std::unique_ptr<char[]> buffer_;
  std::size_t room_ = 0;  // of the buffer
  std::size_t size_ = 0;
  std::size_t used_ = 0;
  std::size_t lines_ = 0;
  std::size_t taken_ = 0;  // bytes, as lines
  bool line_ended_ = true;
};

}  // namespace offnominal::desk
