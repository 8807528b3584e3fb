#include "studio/upload_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "common/refused.hpp"

namespace offnominal::desk::studio {
namespace {

constexpr std::size_t kLongestUploadName = 200;  // bytes
constexpr const char* kMendLimit =
    "start Studio with it on the command line, where there is no limit";

std::string file_name_of(const std::filesystem::path& path) { return path.filename().string(); }

void check_name(const std::string& name) {
  const bool has_none = std::none_of(name.begin(), name.end(), [](char c) {
    return c == '/' || c == '\\' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
  });
  const bool is_folder = name.empty() || name == "." || name == "..";
  if (has_none && !is_folder && name.size() <= kLongestUploadName) return;
  throw Refused(Refused::Why::kBadRequest,
                fmt::format("A file is handed over by its name without a folder, at most {} bytes "
                            "long.",
                            kLongestUploadName));
}

[[noreturn]] void fail_to_write(const std::filesystem::path& path, int error) {
  throw InputError(
      {file_name_of(path), "",
       "no place for it among the temporary files: " + std::generic_category().message(error), "",
       "set TMPDIR to a folder with more room and start Studio again"});
}

}  // namespace

std::string bytes_words(std::uint64_t bytes) {
  constexpr std::array<const char*, 4> kUnits = {"bytes", "KiB", "MiB", "GiB"};
  auto size = static_cast<double>(bytes);
  std::size_t unit = 0;
  while (size >= 1024 && unit + 1 < kUnits.size()) {
    size /= 1024;
    ++unit;
  }
  return fmt::format("{:.3g} {}", size, kUnits[unit]);
}

UploadFolder::UploadFolder(UploadLimits limits) : limits_(limits) {
  std::error_code failure;
  const std::filesystem::path among = std::filesystem::temp_directory_path(failure);
  std::string name = (among / "offnominal-studio-XXXXXX").string();
  // For nobody else, mode 0700.
  if (failure || ::mkdtemp(name.data()) == nullptr) {
    throw InputError({among.string(), "", "no folder for what the page is given", "",
                      "set TMPDIR to a folder that can be written"});
  }
  path_ = name;
}

UploadFolder::~UploadFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

UploadFolder::Upload UploadFolder::begin(const std::string& name) {
  check_name(name);
  const std::filesystem::path own = path_ / std::to_string(++count_);
  const std::filesystem::path path = own / name;
  if (::mkdir(own.c_str(), S_IRWXU) != 0) fail_to_write(path, errno);
  const int file =
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file < 0) fail_to_write(path, errno);
  return {*this, path, file};
}

std::filesystem::path UploadFolder::put(const std::string& name, const std::string& content) {
  Upload upload = begin(name);
  upload.write(content.data(), content.size());
  return upload.finish();
}

void UploadFolder::remove(const std::filesystem::path& path) {
  if (path.parent_path().parent_path() != path_) return;
  std::error_code failure;
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  if (!failure) used_ -= size;
  std::filesystem::remove_all(path.parent_path(), failure);
}

std::string UploadFolder::shown(const std::string& words) const {
  const std::string folder = path_.string() + "/";
  std::string all = words;
  for (auto at = all.find(folder); at != std::string::npos; at = all.find(folder, at)) {
    std::size_t end = at + folder.size();
    while (end < all.size() && all[end] >= '0' && all[end] <= '9') ++end;
    if (end < all.size() && all[end] == '/') ++end;
    all.erase(at, end - at);
  }
  return all;
}

InputError UploadFolder::shown(const InputError& error) const {
  const InputProblem& problem = error.problem();
  return InputError({shown(problem.file), shown(problem.place), shown(problem.found),
                     shown(problem.allowed), shown(problem.mend)});
}

UploadFolder::Upload::Upload(UploadFolder& folder, std::filesystem::path path, int file)
    : folder_(&folder), path_(std::move(path)), file_(file) {}

UploadFolder::Upload::Upload(Upload&& other) noexcept
    : folder_(other.folder_),
      path_(std::move(other.path_)),
      file_(std::exchange(other.file_, -1)),
      size_(other.size_) {}

UploadFolder::Upload::~Upload() {
  if (file_ < 0) return;
  ::close(file_);
  folder_->used_ -= size_;
  std::error_code ignored;
  std::filesystem::remove_all(path_.parent_path(), ignored);
}

InputError UploadFolder::Upload::too_long() const {
  const std::string most = bytes_words(folder_->limits_.file);
  return InputError(
      {file_name_of(path_), "", "more than " + most, most + " a file on the page", kMendLimit});
}

void UploadFolder::Upload::write(const char* data, std::size_t size) {
  const UploadLimits& limits = folder_->limits_;
  if (size_ + size > limits.file) throw too_long();
  folder_->used_ += size;
  size_ += size;
  if (folder_->used_ > limits.all) {
    throw InputError({file_name_of(path_), "",
                      "files of more than " + bytes_words(limits.all) + " together",
                      bytes_words(limits.all) + " on the page", kMendLimit});
  }
  while (size > 0) {
    const ssize_t written = ::write(file_, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(path_, errno);
    data += written;
    size -= static_cast<std::size_t>(written);
  }
}

std::filesystem::path UploadFolder::Upload::finish() {
  const int file = std::exchange(file_, -1);
  if (::close(file) != 0) fail_to_write(path_, errno);
  return path_;
}

}  // namespace offnominal::desk::studio
