#include "common/file.hpp"

#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <mutex>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include "common/error.hpp"

namespace offnominal::desk {
namespace {

std::string reason(int error) { return std::generic_category().message(error); }

[[noreturn]] void refuse_existing(const std::filesystem::path& path) {
  throw InputError({.file = path.string(),
                    .place = "",
                    .found = "a file that is already there",
                    .allowed = "a new file",
                    .mend = "choose another name, or remove the file first"});
}

[[noreturn]] void refuse_to_write(const std::filesystem::path& path, int error) {
  throw InputError({.file = path.string(),
                    .place = "",
                    .found = "that it cannot be written (" + reason(error) + ")",
                    .allowed = "",
                    .mend = "name a file in a folder that exists, is writable and has room"});
}

// Of a process: what any of its threads has read.
struct Kept {
  std::mutex mutex;
  std::set<std::filesystem::path> files;
};

Kept& kept() {
  static Kept files;
  return files;
}

void refuse_kept(const std::filesystem::path& path, const std::filesystem::path& target) {
  Kept& files = kept();
  const std::lock_guard lock(files.mutex);
  for (const std::filesystem::path& file : files.files) {
    std::error_code ignored;
    if (!std::filesystem::equivalent(file, target, ignored)) continue;
    throw InputError({.file = path.string(),
                      .place = "",
                      .found = "what was read: a recording, or what decodes it",
                      .allowed = "a file of its own",
                      .mend = "choose another name"});
  }
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

// `path`, or what it links to. Throws where something that is no regular file stands there.
std::filesystem::path target_of(const std::filesystem::path& path) {
  const auto refuse = [&path](const std::string& found) {
    throw InputError({.file = path.string(),
                      .place = "",
                      .found = found,
                      .allowed = "a new or a regular file",
                      .mend = "choose another name"});
  };
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    if (std::filesystem::is_symlink(path, ignored)) refuse("a link to nothing");
    return path;
  }
  if (std::filesystem::is_directory(path, ignored)) refuse("a folder");
  if (!std::filesystem::is_regular_file(path, ignored)) {
    refuse("something that is not a regular file");
  }
  return std::filesystem::canonical(path);
}

class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  [[nodiscard]] int get() const { return value_; }
  void reset(int value) {
    if (value_ >= 0) ::close(value_);
    value_ = value;
  }

 private:
  int value_;
};

/// A file being written, which has no name until it is whole: however the program ends, nothing is
/// left of it. On a file system that has no files without a name it has one beside its final one,
/// and is removed unless the program is killed.
class Temporary {
 public:
  explicit Temporary(std::filesystem::path target)
      : target_(std::move(target)),
        name_(target_.string() + ".part-" + std::to_string(::getpid())),
        file_(::open(folder_of(target_).c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666)) {
    if (file_.get() >= 0) return;
    file_.reset(::open(name_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666));
    named_ = file_.get() >= 0;
    if (!named_) fail();
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  ~Temporary() {
    if (named_) ::unlink(name_.c_str());
  }

  void keep_mode_of_target() {
    struct stat status {};
    if (::stat(target_.c_str(), &status) == 0) ::fchmod(file_.get(), status.st_mode & 07777);
  }

  void write(std::string_view content) {
    while (!content.empty()) {
      const ssize_t written = ::write(file_.get(), content.data(), content.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail();
      content.remove_prefix(static_cast<std::size_t>(written));
    }
    if (::fsync(file_.get()) != 0) fail();
  }

  void move_to_target(Existing existing) {
    if (existing == Existing::kRefuse && !named_) {
      give_name(target_);
    } else if (existing == Existing::kReplace) {
      if (!named_) {
        ::unlink(name_.c_str());
        give_name(name_);
        named_ = true;
      }
      if (::rename(name_.c_str(), target_.c_str()) != 0) fail();
      named_ = false;
    } else if (::renameat2(AT_FDCWD, name_.c_str(), AT_FDCWD, target_.c_str(), RENAME_NOREPLACE) ==
               0) {
      named_ = false;
    } else if (errno == EINVAL || errno == ENOSYS) {
      // A file system without RENAME_NOREPLACE: a hard link refuses an existing name too.
      if (::link(name_.c_str(), target_.c_str()) != 0) fail();
    } else {
      fail();
    }
    flush_folder();
  }

 private:
  // Refuses a name that there is.
  void give_name(const std::filesystem::path& name) const {
    const std::string file = "/proc/self/fd/" + std::to_string(file_.get());
    if (::linkat(AT_FDCWD, file.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0) fail();
  }

  [[noreturn]] void fail() const {
    const int error = errno;
    if (error == EEXIST) refuse_existing(target_);
    refuse_to_write(target_, error);
  }

  // The new name is only as lasting as the folder's own entry. Some file systems cannot flush a
  // folder; the content is safe by then, so that is no failure.
  void flush_folder() const {
    const Descriptor descriptor(
        ::open(folder_of(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (descriptor.get() >= 0) static_cast<void>(::fsync(descriptor.get()));
  }

  std::filesystem::path target_;
  std::filesystem::path name_;
  Descriptor file_;
  bool named_ = false;  // name_ is its own
};

}  // namespace

std::string read_text_file(const std::filesystem::path& path) {
  const auto refuse = [&path](const std::string& found,
                              const std::string& allowed = "a readable file",
                              const std::string& mend = "check the name and its permissions") {
    throw InputError(
        {.file = path.string(), .place = "", .found = found, .allowed = allowed, .mend = mend});
  };
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) {
    refuse(errno == ENOENT ? "nothing: there is no such file"
                           : "a file that cannot be read (" + reason(errno) + ")");
  }
  struct stat status {};
  if (::fstat(file.get(), &status) == 0 && S_ISDIR(status.st_mode)) refuse("a folder");
  std::string content;
  char block[65536];
  for (;;) {
    const ssize_t count = ::read(file.get(), block, sizeof block);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse("a file that cannot be read (" + reason(errno) + ")");
    if (count <= 0) return content;
    content.append(block, static_cast<std::size_t>(count));
    if (content.size() > kMostText) {
      refuse("more than " + std::to_string(kMostText >> 20) + " MiB", "a text file of less",
             "check the name");
    }
  }
}

void check_can_be_written(const std::filesystem::path& path) {
  const std::filesystem::path target = target_of(path);
  if (::access(folder_of(target).c_str(), W_OK | X_OK) != 0) refuse_to_write(path, errno);
}

void keep_as_it_is(const std::filesystem::path& path) {
  std::error_code failure;
  std::filesystem::path file = std::filesystem::canonical(path, failure);
  if (failure) return;
  Kept& files = kept();
  const std::lock_guard lock(files.mutex);
  files.files.insert(std::move(file));
}

void write_file_atomically(const std::filesystem::path& path, std::string_view content,
                           Existing existing) {
  const std::filesystem::path target = target_of(path);
  std::error_code ignored;
  if (existing == Existing::kRefuse && std::filesystem::exists(target, ignored)) {
    refuse_existing(path);
  }
  refuse_kept(path, target);
  Temporary temporary(target);
  temporary.keep_mode_of_target();
  temporary.write(content);
  temporary.move_to_target(existing);
}

}  // namespace offnominal::desk
