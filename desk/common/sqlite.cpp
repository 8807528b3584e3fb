#include "common/sqlite.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include "common/error.hpp"

namespace offnominal::desk {
namespace {

[[noreturn]] void refuse(const std::string& file, int code, const std::string& words) {
  switch (code & 0xff) {  // what an extended code is a case of
    case SQLITE_NOTADB:
    case SQLITE_CORRUPT:
      throw InputError({.file = file,
                        .place = "",
                        .found = "no SQLite file, or a damaged one (" + words + ")",
                        .allowed = "results that offnominal wrote",
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
                        .allowed = "results that offnominal wrote",
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

void require_kind(Database& database, const FileKind& kind) {
  const auto number = [&](const char* what) {
    return database.text_of(fmt::format("PRAGMA {}", what)).value_or("0");
  };
  if (number("application_id") != std::to_string(kind.application)) {
    throw InputError({.file = database.file(),
                      .place = "",
                      .found = "another kind of file",
                      .allowed = kind.words,
                      .mend = "it was left as it is: name another file"});
  }
  if (number("user_version") != std::to_string(kind.format)) {
    throw InputError({.file = database.file(),
                      .place = "",
                      .found = "results of format " + number("user_version"),
                      .allowed = std::to_string(kind.format),
                      .mend = "use the version of offnominal that wrote them"});
  }
  const std::string state = database.text_of("PRAGMA quick_check(1)").value_or("no answer");
  if (state == "ok") return;
  throw InputError({.file = database.file(),
                    .place = "",
                    .found = "a damaged file (" + state + ")",
                    .allowed = kind.words,
                    .mend = "it was left as it is: take a copy, or name another file"});
}

void mark_kind(Database& database, const FileKind& kind) {
  database.run(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", kind.application,
                           kind.format));
}

Database open_results(const std::filesystem::path& path, const FileKind& kind) {
  // SQLite's words for a missing file do not name what is wrong.
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    throw InputError({path.string(), "", "no such file", kind.words, ""});
  }
  Database database(path, OpenAs::kRead);
  require_kind(database, kind);
  return database;
}

void write_database(const std::filesystem::path& path, Existing existing,
                    const std::function<void(Database& database)>& fill) {
  check_can_be_written(path);
  std::filesystem::path partial = path;
  partial += ".partial";
  std::filesystem::remove(partial);
  {
    Database database(partial, OpenAs::kNew);
    Transaction whole(database);
    fill(database);
    whole.commit();
  }
  std::error_code ignored;
  if (existing == Existing::kRefuse && std::filesystem::exists(path, ignored)) {
    std::filesystem::remove(partial);
    throw InputError({path.string(), "", "a file that is there", "a new one", "say --force"});
  }
  std::filesystem::rename(partial, path);
}

}  // namespace offnominal::desk
