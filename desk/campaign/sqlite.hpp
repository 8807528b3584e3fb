#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

struct sqlite3;
struct sqlite3_stmt;

// SQLite (https://www.sqlite.org/c3ref/intro.html) as far as results need it. Every error is an
// InputError with the file's name and SQLite's own words.

namespace offnominal::desk::campaign {

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

}  // namespace offnominal::desk::campaign
