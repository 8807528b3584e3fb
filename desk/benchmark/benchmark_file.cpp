#include "benchmark/benchmark_file.hpp"

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/error.hpp"
#include "common/sqlite.hpp"

namespace offnominal::desk::benchmark {
namespace {

const FileKind& kind_of_file() {
  static const FileKind kind{.application = 0x6f666e62,  // "ofnb"
                             .format = 1,
                             .words = "results that ./dev bench discovery --results wrote"};
  return kind;
}

constexpr const char* kSchema = R"(
CREATE TABLE benchmark (name TEXT NOT NULL, command TEXT NOT NULL, base_seed INTEGER NOT NULL);
CREATE TABLE cases (
  number INTEGER PRIMARY KEY, case_group TEXT NOT NULL, seed INTEGER NOT NULL, hidden TEXT NOT NULL,
  said TEXT NOT NULL, verdict TEXT NOT NULL, wrong TEXT NOT NULL, failed TEXT NOT NULL,
  time_s REAL NOT NULL, folder TEXT NOT NULL);
CREATE TABLE asked (
  number INTEGER NOT NULL, place INTEGER NOT NULL, effect TEXT NOT NULL, joint INTEGER NOT NULL,
  share REAL, outcome TEXT NOT NULL, class_size INTEGER NOT NULL, instead TEXT NOT NULL,
  PRIMARY KEY (number, place)) WITHOUT ROWID;
)";

constexpr std::array<const char*, kOutcomes> kNames{"named", "in_class", "missed"};

Outcome outcome_of(const std::string& name, const std::string& file) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<Outcome>(i);
  }
  throw InputError({file, "table asked, outcome", name, "named, in_class or missed",
                    "use the version of offnominal that wrote them"});
}

std::vector<std::string> names_of(const std::string& text, const std::string& file) {
  try {
    return nlohmann::json::parse(text).get<std::vector<std::string>>();
  } catch (const nlohmann::json::exception&) {
    throw InputError({file, "table cases, wrong", text, "a JSON array of names",
                      "use the version of offnominal that wrote them"});
  }
}

void insert(Database& database, const Case& one) {
  Statement row(database, "INSERT INTO cases VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  row.bind(0, one.number);
  row.bind(1, one.group);
  row.bind(2, static_cast<std::int64_t>(one.seed));
  row.bind(3, one.hidden);
  row.bind(4, one.said);
  row.bind(5, one.verdict);
  row.bind(6, nlohmann::json(one.wrong).dump());
  row.bind(7, one.failed);
  row.bind(8, one.time_s);
  row.bind(9, one.folder);
  row.step();
  Statement asked(database, "INSERT INTO asked VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t i = 0; i < one.asked.size(); ++i) {
    const Asked& of = one.asked[i];
    asked.bind(0, one.number);
    asked.bind(1, static_cast<std::int64_t>(i));
    asked.bind(2, of.effect);
    asked.bind(3, std::int64_t{of.joint});
    asked.bind(4, of.share);
    asked.bind(5, std::string(name_of(of.outcome)));
    asked.bind(6, std::int64_t{of.class_size});
    asked.bind(7, of.instead);
    asked.step();
  }
}

void read_asked(Database& database, Case& one) {
  Statement all(
      database,
      "SELECT effect, joint, share, outcome, class_size, instead FROM asked WHERE number = "
      "? ORDER BY place");
  all.bind(0, one.number);
  while (all.step()) {
    Asked asked;
    asked.effect = all.text(0);
    asked.joint = static_cast<int>(all.integer(1));
    if (!all.is_null(2)) asked.share = all.real(2);
    asked.outcome = outcome_of(all.text(3), database.file());
    asked.class_size = static_cast<int>(all.integer(4));
    asked.instead = all.text(5);
    one.asked.push_back(std::move(asked));
  }
}

}  // namespace

const char* name_of(Outcome outcome) { return kNames[static_cast<std::size_t>(outcome)]; }

Results read_benchmark(const std::filesystem::path& path) {
  Database database = open_results(path, kind_of_file());
  Results results;
  Statement whole(database, "SELECT name, command, base_seed FROM benchmark");
  if (!whole.step()) {
    throw InputError({database.file(), "table benchmark", "no row", "one", "name another file"});
  }
  results.name = whole.text(0);
  results.command = whole.text(1);
  results.base_seed = static_cast<std::uint64_t>(whole.integer(2));
  Statement all(
      database,
      "SELECT number, case_group, seed, hidden, said, verdict, wrong, failed, time_s, folder "
      "FROM cases ORDER BY number");
  while (all.step()) {
    Case one;
    one.number = all.integer(0);
    one.group = all.text(1);
    one.seed = static_cast<std::uint64_t>(all.integer(2));
    one.hidden = all.text(3);
    one.said = all.text(4);
    one.verdict = all.text(5);
    one.wrong = names_of(all.text(6), database.file());
    one.failed = all.text(7);
    one.time_s = all.real(8);
    one.folder = all.text(9);
    if (std::filesystem::path(one.folder).is_absolute()) {
      throw InputError({database.file(), "table cases, folder", one.folder,
                        "a folder as seen from the file", "take the file as it was written"});
    }
    read_asked(database, one);
    results.cases.push_back(std::move(one));
  }
  return results;
}

void write_benchmark(const std::filesystem::path& path, const Results& results, Existing existing) {
  write_database(path, existing, [&](Database& database) {
    database.run(kSchema);
    Statement whole(database, "INSERT INTO benchmark VALUES (?, ?, ?)");
    whole.bind(0, results.name);
    whole.bind(1, results.command);
    whole.bind(2, static_cast<std::int64_t>(results.base_seed));
    whole.step();
    for (const Case& one : results.cases) insert(database, one);
    mark_kind(database, kind_of_file());
  });
}

}  // namespace offnominal::desk::benchmark
