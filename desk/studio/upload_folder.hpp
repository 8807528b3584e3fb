#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "common/error.hpp"

namespace offnominal::desk::studio {

/// How much a page may hand over, bytes.
struct UploadLimits {
  std::uint64_t file = std::uint64_t{1} << 30;
  std::uint64_t all = std::uint64_t{4} << 30;  // that lie there at the same time
};

/// Where the files lie that a page hands over: a folder of its own among the system's temporary
/// ones, which nobody but this user can enter, and which goes with this object. A file keeps its
/// name, since a recording's kind follows from it; it lies in a folder of its own below.
class UploadFolder {
 public:
  /// Throws InputError where there is no place for temporary files.
  explicit UploadFolder(UploadLimits limits = {});
  UploadFolder(const UploadFolder&) = delete;
  UploadFolder& operator=(const UploadFolder&) = delete;
  ~UploadFolder();

  /// A file on its way. One that is not finished is gone with it.
  class Upload {
   public:
    Upload(Upload&& other) noexcept;
    Upload& operator=(Upload&&) = delete;
    Upload(const Upload&) = delete;
    Upload& operator=(const Upload&) = delete;
    ~Upload();

    /// Throws InputError for more than the limits allow, and where the disk is full.
    void write(const char* data, std::size_t size);
    /// What write() says of a file beyond the limit.
    [[nodiscard]] InputError too_long() const;
    /// Where the file is.
    [[nodiscard]] std::filesystem::path finish();

   private:
    friend class UploadFolder;
    Upload(UploadFolder& folder, std::filesystem::path path, int file);

    UploadFolder* folder_;
    std::filesystem::path path_;
    int file_;
    std::uint64_t size_ = 0;
  };

  /// `name`: of the file, without a folder. Throws Refused for anything else. From any thread.
  [[nodiscard]] Upload begin(const std::string& name);
  /// A small one at once.
  [[nodiscard]] std::filesystem::path put(const std::string& name, const std::string& content);
  /// Takes away what begin() or put() gave.
  void remove(const std::filesystem::path& path);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const UploadLimits& limits() const { return limits_; }
  [[nodiscard]] std::uint64_t used() const { return used_; }

  /// Files by their names alone, as the user knows them.
  [[nodiscard]] std::string shown(const std::string& words) const;
  [[nodiscard]] InputError shown(const InputError& error) const;

 private:
  UploadLimits limits_;
  std::filesystem::path path_;
  std::atomic<std::uint64_t> used_ = 0;
  std::atomic<std::uint64_t> count_ = 0;
};

/// "1 GiB", "16 KiB", "12 bytes".
[[nodiscard]] std::string bytes_words(std::uint64_t bytes);

}  // namespace offnominal::desk::studio
