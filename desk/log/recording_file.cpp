#include "log/recording_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/input_name.hpp"
#include "log/log_format.hpp"

namespace offnominal::desk {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 18;

std::string allowed() { return "a recording: " + log_format_names(); }

bool write_all(int file, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(file, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

RecordingFile::RecordingFile(const std::filesystem::path& path, const std::filesystem::path& joined)
    : path_(path), name_(shown_name(path)) {
  const int file = names_standard_input(path) ? ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0)
                                              : ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const int error = errno;
  if (file < 0 && error == ENOENT) {
    fail("", "no such file", allowed(),
         joined.empty() || joined == path
             ? "check the name"
             : "check the name: " + joined.string() +
                   " was read as files that + joins, since there is none of that whole name");
  }
  if (file < 0) {
    fail("", "a file that cannot be opened (" + std::generic_category().message(error) + ")",
         allowed());
  }
  stream_ = stream_of(file);
  if (!names_standard_input(path)) keep_as_it_is(path);
  struct stat status {};
  if (::fstat(file, &status) == 0 && S_ISDIR(status.st_mode)) {
    fail("", "a folder", allowed(),
         "name the recordings in it; of a bag of ROS 2, write the topic as CSV: ros2 topic echo "
         "--csv");
  }
  try {
    stream_ = plain_stream(std::move(stream_), is_as_stored_);
  } catch (const StreamError& problem) {
    fail("", problem.what(), allowed(), problem.mend);
  }
  // A pipe gives less than was asked for, and more later.
  while (size_ < kBeginning && fill()) {
  }
  beginning_ = std::string(buffer_.get(), std::min(size_, kBeginning));
}

RecordingFile::~RecordingFile() {
  if (copy_ >= 0) ::close(copy_);
}

void RecordingFile::fail(const std::string& place, const std::string& found,
                         const std::string& allowed, const std::string& mend) const {
  throw InputError({name_, place, found, allowed, mend});
}

// What is left of the buffer moves to its beginning; where that fills it, it grows.
bool RecordingFile::fill() {
  const std::size_t left = size_ - used_;
  if (room_ < left + kBlock) {
    const std::size_t room = std::max(2 * room_, left + kBlock);
    std::unique_ptr<char[]> larger(new char[room]);
    if (left > 0) std::memcpy(larger.get(), buffer_.get() + used_, left);
    buffer_ = std::move(larger);
    room_ = room;
  } else if (left > 0) {
    std::memmove(buffer_.get(), buffer_.get() + used_, left);
  }
  used_ = 0;
  size_ = left;
  try {
    const std::size_t count = stream_->read(buffer_.get() + size_, kBlock);
    size_ += count;
    return count > 0;
  } catch (const StreamError& problem) {
    fail("", problem.what(), allowed(), problem.mend);
  }
}

bool RecordingFile::next_line(std::string_view& line) {
  std::size_t looked_at = 0;  // of what is not used
  const void* end = nullptr;
  const auto look = [&] {
    const char* const from = buffer_.get() + used_ + looked_at;
    end = std::memchr(from, '\n', size_ - used_ - looked_at);
    return end != nullptr;
  };
  while (!look()) {
    looked_at = size_ - used_;
    if (looked_at > kLongestLine) break;
    if (!fill()) break;
  }
  line_ended_ = end != nullptr;
  const char* const begin = buffer_.get() + used_;
  const std::size_t length =
      line_ended_ ? static_cast<std::size_t>(static_cast<const char*>(end) - begin) : size_ - used_;
  if (length == 0 && !line_ended_) return false;
  line = std::string_view(begin, length);
  if (line.find('\0') != std::string_view::npos) {
    fail(line_place(), "bytes that are no text", allowed(), "save it as text in UTF-8");
  }
  if (length > kLongestLine) {
    fail(line_place(), "a line longer than " + std::to_string(kLongestLine) + " bytes",
         "one line per sample", "look for a file without line ends, or one of another kind");
  }
  used_ += length + (line_ended_ ? 1 : 0);
  ++lines_;
  taken_ += length;
  if (taken_ > kMostLines) refuse_size(kMostLines, "cut it into parts");
  return true;
}

bool RecordingFile::next_line(std::string& line) {
  std::string_view view;
  if (!next_line(view)) return false;
  line = view;
  return true;
}

void RecordingFile::refuse_size(std::size_t most, const std::string& mend) const {
  fail("", "more than " + std::to_string(most >> 30) + " GiB", "a recording that ends", mend);
}

void RecordingFile::refuse_copy(const std::error_code& error) const {
  fail("", "that no copy of it can be kept (" + error.message() + ")",
       "a folder for temporary files that exists, with room in it",
       "set TMPDIR to another, or save it as a file and name that");
}

int RecordingFile::nameless_file() const {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  if (error) refuse_copy(error);
  std::string name = (folder / "offnominal-XXXXXX").string();
  const int file = ::mkostemp(name.data(), O_CLOEXEC);
  if (file < 0) refuse_copy({errno, std::generic_category()});
  ::unlink(name.c_str());
  return file;
}

void RecordingFile::copy_to(int file) {
  const auto written = [&](std::string_view part) {
    if (!write_all(file, part)) refuse_copy({errno, std::generic_category()});
  };
  std::size_t size = 0;
  do {
    written(std::string_view(buffer_.get() + used_, size_ - used_));
    size += size_ - used_;
    used_ = size_;
    if (size > kMostCopied) refuse_size(kMostCopied, "save it as a file and name that");
  } while (fill());
}

std::filesystem::path RecordingFile::seekable() {
  std::error_code ignored;
  if (is_as_stored_ && !names_standard_input(path_) &&
      std::filesystem::is_regular_file(path_, ignored)) {
    return path_;
  }
  if (copy_ < 0) {
    copy_ = nameless_file();
    copy_to(copy_);
  }
  return "/proc/self/fd/" + std::to_string(copy_);
}

}  // namespace offnominal::desk
