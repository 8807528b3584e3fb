#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "log/joined_files.hpp"
#include "log/named_columns.hpp"
#include "robot/robot.hpp"
#include "studio/kept_columns.hpp"

// A recording of what a page is given: of one file, or of several that are joined by their times.

namespace offnominal::desk::studio {

/// A file of recordings, with every column that has numbers.
struct GivenFile {
  std::size_t id = 0;  // never used twice
  std::filesystem::path path;
  std::string name;
  std::shared_ptr<const NamedColumns> columns;
  std::string of;        // fingerprint of its content
  bool by_hand = false;  // with which files it goes, or that it goes alone, the user has said
  std::string wants;  // fingerprint of the file that it was joined to before, and is not there yet
  // Of the recording that it is the first file of.
  bool held_out = false;
  std::optional<Payload> payload = {};
};

class GivenRecording {
 public:
  /// One file or more. `why`: they go together, in words; empty: the user said so.
  explicit GivenRecording(std::vector<GivenFile> files, std::string why = {});

  /// Of its first file.
  [[nodiscard]] std::size_t id() const { return files_.front().id; }
  [[nodiscard]] GivenFile& first() { return files_.front(); }
  [[nodiscard]] const GivenFile& first() const { return files_.front(); }
  [[nodiscard]] const std::vector<GivenFile>& files() const { return files_; }
  [[nodiscard]] bool is_by_hand() const { return files_.front().by_hand; }
  [[nodiscard]] const std::string& why() const { return why_; }
  /// Where every verb reads it, "/tmp/1/a.csv+/tmp/2/b.csv", and how it is called, "a.csv+b.csv".
  [[nodiscard]] std::string path() const;
  [[nodiscard]] std::string name() const;

  /// Of all files, by the names that they have together (named_together()): of several files
  /// without values.
  [[nodiscard]] const NamedColumns& columns() const;
  /// As its file has it; null: there is no such column.
  [[nodiscard]] const Eigen::VectorXd* values_of(const std::string& source) const;
  /// What the user has said of its files, in their order.
  [[nodiscard]] std::vector<SaidOfFile> said() const;
  /// As every verb reads it by these channels. Throws InputError.
  [[nodiscard]] TimedColumns timed(const ChannelMap& map) const;

  /// {id, name, bytes, files, why_joined, held_out, payload}.
  [[nodiscard]] nlohmann::ordered_json json() const;

 private:
  std::vector<GivenFile> files_;
  std::string why_;
  NamedColumns together_;
};

}  // namespace offnominal::desk::studio
