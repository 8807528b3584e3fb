#include "campaign/sqlite.hpp"

#include <sqlite3.h>

#include "common/error.hpp"

namespace offnominal::desk::campaign {
namespace {

[[noreturn]] void refuse(const std::string& file, int code, const std::string& words) {
  switch (code & 0xff) {  // what an extended code is a case of
    case SQLITE_NOTADB:
    case SQLITE_CORRUPT:
      throw InputError({.file = file,
                        .place = "",
                        .found = "no SQLite file, or a damaged one (" + words + ")",
                        .allowed = "results that offnominal campaign wrote",
                        .mend = "it was left as it is: take a copy, or name another file"});
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw InputError({.file = file,
                        .place = "",
                        .found = "a file that another process writes",
                        .allowed = "one process for each file of results",
                        .mend = "wait for it, or give this one a file of its own"});
    case SQLITE_FULL:
    case SQLITE_IOERR:
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
      throw InputError({.file = file,
                        .place = "",
                        .found = "that it cannot be read or written (" + words + ")",
                        .allowed = "",
                        .mend = "check folder, permissions and room; runs that are in it stay"});
    default:
      throw InputError({.file = file,
                        .place = "",
                        .found = "what SQLite refuses (" + words + ")",
                        .allowed = "results that offnominal campaign wrote",
                        .mend = ""});
  }
}

// Reading too: what a process that was killed left half-written is rolled back first. A file that
// may not be written is opened all the same.
int flags_of(OpenAs as) {
  return as == OpenAs::kNew ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READWRITE;
}

}  // namespace

void Database::Close::operator()(sqlite3* handle) const { sqlite3_close(handle); }

Database::Database(const std::filesystem::path& path, OpenAs as) : file_(path.string()) {
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(file_.c_str(), &handle, flags_of(as), nullptr);
  handle_.reset(handle);
  if (code != SQLITE_OK) refuse(file_, code, sqlite3_errstr(code));
}

void Database::fail() const {
  refuse(file_, sqlite3_extended_errcode(handle_.get()), sqlite3_errmsg(handle_.get()));
}

void Database::run(const std::string& sql) {
  if (sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

std::optional<std::string> Database::text_of(const std::string& sql) {
  Statement statement(*this, sql);
  if (!statement.step()) return std::nullopt;
  return statement.text(0);
}

Transaction::Transaction(Database& database) : database_(database) {
  database_.run("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  if (done_) return;
  try {
    database_.run("ROLLBACK");
  } catch (const InputError&) {  // what went wrong before is on its way already
  }
}

void Transaction::commit() {
  database_.run("COMMIT");
  done_ = true;
}

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Statement::Statement(Database& database, const std::string& sql) : database_(database) {
  sqlite3_stmt* handle = nullptr;
  check(sqlite3_prepare_v2(database.handle_.get(), sql.c_str(), -1, &handle, nullptr));
  handle_.reset(handle);
}

void Statement::check(int code) const {
  if (code != SQLITE_OK) database_.fail();
}

void Statement::bind(int at, std::int64_t value) {
  check(sqlite3_bind_int64(handle_.get(), at + 1, value));
}

void Statement::bind(int at, double value) {
  check(sqlite3_bind_double(handle_.get(), at + 1, value));
}

void Statement::bind(int at, const std::string& value) {
  check(sqlite3_bind_text(handle_.get(), at + 1, value.c_str(), static_cast<int>(value.size()),
                          SQLITE_TRANSIENT));
}

void Statement::bind_null(int at) { check(sqlite3_bind_null(handle_.get(), at + 1)); }

bool Statement::step() {
  const int code = sqlite3_step(handle_.get());
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) database_.fail();
  check(sqlite3_reset(handle_.get()));
  return false;
}

bool Statement::is_null(int column) const {
  return sqlite3_column_type(handle_.get(), column) == SQLITE_NULL;
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(handle_.get(), column);
}

double Statement::real(int column) const { return sqlite3_column_double(handle_.get(), column); }

std::string Statement::text(int column) const {
  const auto* const bytes = sqlite3_column_text(handle_.get(), column);
  if (bytes == nullptr) return {};
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column));
  return {static_cast<const char*>(static_cast<const void*>(bytes)), size};
}

}  // namespace offnominal::desk::campaign
