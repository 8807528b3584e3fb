#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "robot/robot.hpp"

namespace offnominal::desk::studio {

/// What a user has said of a file that was dropped.
struct SaidOfFile {
  bool held_out = false;
  std::optional<Payload> payload = {};
  bool by_hand = false;   // with which files it goes, or that it goes alone
  std::string joined_to;  // fingerprint of the first file of its recording; empty: it is the first

  friend bool operator==(const SaidOfFile& a, const SaidOfFile& b);
};

/// What was said of dropped files, for the next program that is given the same: in a file of its
/// own, written whole after every change. Columns are told by their names and the robot's joints,
/// files by their content, whatever their names. Throws nothing: where it cannot be read or written
/// Studio goes on without, and problem() says so. What else is in the file, of other columns and
/// files or of another program, stays; of each kind the last kMost are kept.
class KeptColumns {
 public:
  static constexpr std::size_t kMost = 200;

  /// Kept nowhere.
  KeptColumns() = default;
  explicit KeptColumns(std::filesystem::path file);

  /// As keep_columns() was given it; null: nothing was said.
  [[nodiscard]] nlohmann::ordered_json columns(const std::string& of) const;
  [[nodiscard]] std::optional<SaidOfFile> file(const std::string& of) const;
  /// null, or none: forgotten.
  void keep_columns(const std::string& of, const nlohmann::ordered_json& said);
  void keep_file(const std::string& of, const std::optional<SaidOfFile>& said);

  /// Empty: kept nowhere.
  [[nodiscard]] std::string name() const { return file_.string(); }
  /// Why the last change is not in the file, in words; empty: it is.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  // Under `kind`; null: there is none.
  [[nodiscard]] nlohmann::ordered_json entry(const char* kind, const std::string& of) const;
  void keep(const char* kind, const std::string& of, nlohmann::ordered_json said);

  std::filesystem::path file_;
  std::string problem_;
};

/// Of a file's length, its beginning and its end; empty: it cannot be read.
[[nodiscard]] std::string content_fingerprint(const std::filesystem::path& file);

}  // namespace offnominal::desk::studio
