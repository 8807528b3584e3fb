#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/file.hpp"

struct sqlite3;
struct sqlite3_stmt;

// SQLite (https://www.sqlite.org/c3ref/intro.html) as far as results need it. Every error is an
// InputError with the file's name and SQLite's own words.

namespace offnominal::desk {

enum class OpenAs : std::uint8_t { kRead, kWrite, kNew };

class Database {
 public:
  /// With kNew the file is made where it is not there.
  Database(const std::filesystem::path& path, OpenAs as);

  void run(const std::string& sql);
  /// The first column of the first row; none: there is no row.
  [[nodiscard]] std::optional<std::string> text_of(const std::string& sql);
  [[nodiscard]] const std::string& file() const { return file_; }
  /// Throws what the last call's error is.
  [[noreturn]] void fail() const;

 private:
  friend class Statement;
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  std::string file_;
  std::unique_ptr<sqlite3, Close> handle_;
};

/// All of a scope or nothing: rolled back unless commit() was called.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  Database& database_;
  bool done_ = false;
};

/// One prepared statement. Columns and parameters count from 0.
class Statement {
 public:
  Statement(Database& database, const std::string& sql);

  void bind(int at, std::int64_t value);
  void bind(int at, double value);
  void bind(int at, const std::string& value);
  void bind_null(int at);
  template <typename Value>
  void bind(int at, const std::optional<Value>& value) {
    if (value) {
      bind(at, *value);
    } else {
      bind_null(at);
    }
  }
  /// Whether there is a row; without one it may be bound and run again.
  bool step();

  [[nodiscard]] bool is_null(int column) const;
  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] double real(int column) const;
  [[nodiscard]] std::string text(int column) const;

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  void check(int code) const;

  Database& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> handle_;
};

/// Which results a file holds, as it says in its head.
struct FileKind {
  std::int64_t application = 0;
  std::int64_t format = 0;  // version of its tables
  std::string words;        // "results that offnominal campaign wrote"
};

/// Throws InputError for a file of another kind or version, or a damaged one; it is left as it is.
void require_kind(Database& database, const FileKind& kind);
void mark_kind(Database& database, const FileKind& kind);
/// To read. Throws as require_kind(), and where there is no such file.
[[nodiscard]] Database open_results(const std::filesystem::path& path, const FileKind& kind);

/// A file that `fill` makes, whole or not at all. Throws InputError where it cannot be written, or
/// is there and must not be replaced.
void write_database(const std::filesystem::path& path, Existing existing,
                    const std::function<void(Database& database)>& fill);

}  // namespace offnominal::desk
