#include "log/recording_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "common/error.hpp"
#include "common/input_name.hpp"
#include "log/log_format.hpp"

namespace offnominal::tools {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 18;

std::string allowed() { return "a recording: " + log_format_names(); }

// As many bytes as there are, up to `size`; negative at an error.
ssize_t read_some(int file, char* to, std::size_t size) {
  for (;;) {
    const ssize_t count = ::read(file, to, size);
    if (count >= 0 || errno != EINTR) return count;
  }
}

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

RecordingFile::RecordingFile(const std::filesystem::path& path)
    : path_(path),
      name_(shown_name(path)),
      file_(names_standard_input(path) ? ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0)
                                       : ::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  const int error = errno;
  if (file_ < 0 && error == ENOENT) fail("", "no such file", allowed());
  if (file_ < 0) {
    fail("", "a file that cannot be opened (" + std::generic_category().message(error) + ")",
         allowed());
  }
  struct stat status {};
  if (::fstat(file_, &status) == 0 && S_ISDIR(status.st_mode)) {
    ::close(file_);
    fail("", "a folder", allowed());
  }
  try {
    // A pipe gives less than was asked for, and more later.
    while (buffer_.size() < kBeginning && fill()) {
    }
  } catch (...) {
    ::close(file_);
    throw;
  }
  beginning_ = buffer_.substr(0, kBeginning);
}

RecordingFile::~RecordingFile() {
  if (file_ >= 0) ::close(file_);
  if (copy_ >= 0) ::close(copy_);
}

void RecordingFile::fail(const std::string& place, const std::string& found,
                         const std::string& allowed, const std::string& mend) const {
  throw InputError({name_, place, found, allowed, mend});
}

bool RecordingFile::fill() {
  if (used_ > 0) buffer_.erase(0, used_);
  used_ = 0;
  const std::size_t kept = buffer_.size();
  buffer_.resize(kept + kBlock);
  const ssize_t count = read_some(file_, buffer_.data() + kept, kBlock);
  const int error = errno;
  buffer_.resize(kept + static_cast<std::size_t>(count < 0 ? 0 : count));
  if (count < 0) {
    fail("", "a file that cannot be read (" + std::generic_category().message(error) + ")",
         allowed());
  }
  return count > 0;
}

bool RecordingFile::next_line(std::string& line) {
  std::size_t looked_at = 0;  // of what is not used
  std::size_t end = std::string::npos;
  while ((end = buffer_.find('\n', used_ + looked_at)) == std::string::npos) {
    looked_at = buffer_.size() - used_;
    if (looked_at > kLongestLine) break;
    if (!fill()) break;
  }
  line_ended_ = end != std::string::npos;
  const std::size_t length = (line_ended_ ? end : buffer_.size()) - used_;
  if (length == 0 && !line_ended_) return false;
  line.assign(buffer_, used_, std::min(length, kLongestLine + 1));
  if (line.find('\0') != std::string::npos) {
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
    written(std::string_view(buffer_).substr(used_));
    size += buffer_.size() - used_;
    used_ = buffer_.size();
    if (size > kMostCopied) refuse_size(kMostCopied, "save it as a file and name that");
  } while (fill());
}

std::filesystem::path RecordingFile::seekable() {
  std::error_code ignored;
  if (!names_standard_input(path_) && std::filesystem::is_regular_file(path_, ignored))
    return path_;
  if (copy_ < 0) {
    copy_ = nameless_file();
    copy_to(copy_);
  }
  return "/proc/self/fd/" + std::to_string(copy_);
}

}  // namespace offnominal::tools
