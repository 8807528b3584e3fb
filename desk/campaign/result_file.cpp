#include "campaign/result_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "common/error.hpp"

namespace offnominal::desk::campaign {
namespace {

const FileKind& kind_of_file() {
  static const FileKind kind{.application = 0x6f666e63,  // "ofnc"
                             .format = 4,
                             .words = "results that offnominal campaign wrote"};
  return kind;
}

constexpr const char* kSchema = R"(
CREATE TABLE campaign (name TEXT NOT NULL, identity TEXT NOT NULL, runs INTEGER NOT NULL);
CREATE TABLE detector (place INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE,
                       thresholds TEXT NOT NULL, notes TEXT NOT NULL);
CREATE TABLE result (
  run INTEGER NOT NULL, detector TEXT NOT NULL, seed INTEGER NOT NULL, kind TEXT NOT NULL,
  joint INTEGER, size REAL, judged_s REAL NOT NULL, fault_s REAL, detected INTEGER NOT NULL,
  delay_s REAL, first_joint INTEGER, joint_right INTEGER, early INTEGER NOT NULL,
  alarms INTEGER NOT NULL, peak_before REAL NOT NULL, peak_after REAL NOT NULL,
  tracking_before_rad REAL, tracking_after_rad REAL, ran_away_s REAL,
  named TEXT, named_joint INTEGER, named_size REAL, named_after_s REAL,
  tracking_end_rad REAL, tracking_end_accommodated_rad REAL, moves_after_s REAL,
  PRIMARY KEY (run, detector)) WITHOUT ROWID;
)";

constexpr const char* kColumns =
    "run, detector, seed, kind, joint, size, judged_s, fault_s, detected, delay_s, first_joint, "
    "joint_right, early, alarms, peak_before, peak_after, tracking_before_rad, tracking_after_rad, "
    "ran_away_s, named, named_joint, named_size, named_after_s, tracking_end_rad, "
    "tracking_end_accommodated_rad, moves_after_s";
constexpr int kColumnCount = 26;

CampaignRow read_campaign_row(Database& database) {
  Statement one(database, "SELECT name, identity, runs FROM campaign");
  CampaignRow row;
  if (!one.step()) {
    throw InputError({database.file(), "table campaign", "no row", "one", "name another file"});
  }
  row.name = one.text(0);
  row.identity = one.text(1);
  row.runs = one.integer(2);
  Statement all(database, "SELECT name, thresholds, notes FROM detector ORDER BY place");
  while (all.step()) row.detectors.push_back({all.text(0), all.text(1), all.text(2)});
  return row;
}

void write_campaign_row(Database& database, const CampaignRow& row) {
  database.run(kSchema);
  Statement one(database, "INSERT INTO campaign VALUES (?, ?, ?)");
  one.bind(0, row.name);
  one.bind(1, row.identity);
  one.bind(2, row.runs);
  one.step();
  Statement each(database, "INSERT INTO detector VALUES (?, ?, ?, ?)");
  for (std::size_t i = 0; i < row.detectors.size(); ++i) {
    each.bind(0, static_cast<std::int64_t>(i));
    each.bind(1, row.detectors[i].name);
    each.bind(2, row.detectors[i].thresholds);
    each.bind(3, row.detectors[i].notes);
    each.step();
  }
  mark_kind(database, kind_of_file());
}

void bind_named(const std::optional<Named>& named, int at, Statement& statement) {
  if (!named) {
    for (int i = 0; i < 4; ++i) statement.bind_null(at + i);
    return;
  }
  statement.bind(at, std::string(name_of(named->kind)));
  const bool has_joint = named->joint >= 0;
  statement.bind(at + 1, has_joint ? std::optional<std::int64_t>(named->joint + 1) : std::nullopt);
  statement.bind(at + 2, named->size);
  statement.bind(at + 3, named->after_s);
}

Named read_named(const Statement& at, int column, const std::string& file) {
  const std::string name = at.text(column);
  for (std::size_t kind = 0; kind < offnominal::kFaultKinds; ++kind) {
    const auto one = static_cast<offnominal::FaultKind>(kind);
    if (name != name_of(one)) continue;
    const int joint = at.is_null(column + 1) ? -1 : static_cast<int>(at.integer(column + 1)) - 1;
    return {one, joint, at.real(column + 2), at.real(column + 3)};
  }
  throw InputError({file, "table result, named", name, "a kind of fault that isolation names",
                    "use the version of offnominal that wrote them"});
}

void insert(Database& database, const std::vector<Result>& rows) {
  const auto whole = [](const auto& value) {
    return value ? std::optional<std::int64_t>(*value) : std::nullopt;
  };
  std::string marks = "?";
  for (int i = 1; i < kColumnCount; ++i) marks += ", ?";
  Statement statement(database,
                      fmt::format("INSERT INTO result ({}) VALUES ({})", kColumns, marks));
  for (const Result& row : rows) {
    int at = 0;
    statement.bind(at++, row.run);
    statement.bind(at++, row.detector);
    statement.bind(at++, static_cast<std::int64_t>(row.seed));
    statement.bind(at++, row.kind);
    statement.bind(at++, whole(row.joint));
    statement.bind(at++, row.size);
    statement.bind(at++, row.judged_s);
    statement.bind(at++, row.fault_s);
    statement.bind(at++, std::int64_t{row.detected});
    statement.bind(at++, row.delay_s);
    statement.bind(at++, whole(row.first_joint));
    statement.bind(at++, whole(row.joint_right));
    statement.bind(at++, std::int64_t{row.early});
    statement.bind(at++, row.alarms);
    statement.bind(at++, row.peak_before);
    statement.bind(at++, row.peak_after);
    statement.bind(at++, row.tracking_before_rad);
    statement.bind(at++, row.tracking_after_rad);
    statement.bind(at++, row.ran_away_s);
    bind_named(row.named, at, statement);
    statement.bind(at + 4, row.tracking_end_rad);
    statement.bind(at + 5, row.tracking_end_accommodated_rad);
    statement.bind(at + 6, row.moves_after_s);
    statement.step();
  }
}

Result read_row(const Statement& at, const std::string& file) {
  const auto real = [&](int column) {
    return at.is_null(column) ? std::nullopt : std::optional<double>(at.real(column));
  };
  const auto whole = [&](int column) {
    return at.is_null(column) ? std::nullopt
                              : std::optional<int>(static_cast<int>(at.integer(column)));
  };
  Result row;
  row.run = at.integer(0);
  row.detector = at.text(1);
  row.seed = static_cast<std::uint64_t>(at.integer(2));
  row.kind = at.text(3);
  row.joint = whole(4);
  row.size = real(5);
  row.judged_s = at.real(6);
  row.fault_s = real(7);
  row.detected = at.integer(8) != 0;
  row.delay_s = real(9);
  row.first_joint = whole(10);
  if (!at.is_null(11)) row.joint_right = at.integer(11) != 0;
  row.early = at.integer(12) != 0;
  row.alarms = at.integer(13);
  row.peak_before = at.real(14);
  row.peak_after = at.real(15);
  row.tracking_before_rad = real(16);
  row.tracking_after_rad = real(17);
  row.ran_away_s = real(18);
  if (!at.is_null(19)) row.named = read_named(at, 19, file);
  row.tracking_end_rad = real(23);
  row.tracking_end_accommodated_rad = real(24);
  row.moves_after_s = real(25);
  return row;
}

void require_same(const CampaignRow& found, const CampaignRow& wanted, const std::string& file,
                  const std::string& other) {
  if (found.identity != wanted.identity) {
    throw InputError(
        {.file = file,
         .place = "",
         .found = "results of another campaign (" + found.name + ")",
         .allowed = "those of " + other + ": the same keys, seed, robots and version of offnominal",
         .mend = "name another file for these results"});
  }
  if (found.detectors == wanted.detectors) return;
  throw InputError({.file = file,
                    .place = "",
                    .found = "results of the same campaign with other thresholds",
                    .allowed = "the thresholds of " + other,
                    .mend = "run all parts with one build of offnominal on one kind of machine"});
}

void sort_rows(Results& results) {
  std::map<std::string, std::size_t> places;
  for (const DetectorRow& one : results.campaign.detectors) places.emplace(one.name, places.size());
  std::sort(results.rows.begin(), results.rows.end(), [&](const Result& a, const Result& b) {
    return a.run != b.run ? a.run < b.run : places[a.detector] < places[b.detector];
  });
  results.missing.clear();
  std::size_t at = 0;
  for (std::int64_t run = 0; run < results.campaign.runs; ++run) {
    std::size_t count = 0;
    for (; at < results.rows.size() && results.rows[at].run == run; ++at) ++count;
    if (count < results.campaign.detectors.size()) results.missing.push_back(run);
  }
}

bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

// Not there, or left empty by a process that ended before it wrote anything.
bool has_nothing(const std::filesystem::path& path) {
  std::error_code ignored;
  return !is_there(path) || (std::filesystem::is_regular_file(path, ignored) &&
                             std::filesystem::file_size(path, ignored) == 0);
}

}  // namespace

void ResultFile::check(const std::filesystem::path& path, const Campaign& campaign) {
  if (has_nothing(path)) {
    check_can_be_written(path);
    return;
  }
  Database database(path, OpenAs::kWrite);
  require_kind(database, kind_of_file());
  CampaignRow found = read_campaign_row(database);
  CampaignRow wanted = found;
  wanted.identity = campaign.identity;
  require_same(found, wanted, path.string(), campaign.file);
}

ResultFile ResultFile::open(const std::filesystem::path& path, const CampaignRow& campaign) {
  const bool is_new = has_nothing(path);
  Database database(path, is_new ? OpenAs::kNew : OpenAs::kWrite);
  if (is_new) {
    Transaction whole(database);
    write_campaign_row(database, campaign);
    whole.commit();
  } else {
    require_kind(database, kind_of_file());
    require_same(read_campaign_row(database), campaign, path.string(), "this campaign");
  }
  return ResultFile(std::move(database));
}

std::vector<std::int64_t> ResultFile::missing_of(std::vector<std::int64_t> runs) {
  std::set<std::int64_t> finished;
  Statement all(database_, "SELECT DISTINCT run FROM result");
  while (all.step()) finished.insert(all.integer(0));
  std::erase_if(runs, [&](std::int64_t run) { return finished.contains(run); });
  return runs;
}

void ResultFile::add(const std::vector<Result>& rows) {
  Transaction whole(database_);
  insert(database_, rows);
  whole.commit();
}

Results read_results(const std::filesystem::path& path) {
  Database database = open_results(path, kind_of_file());
  Results results;
  results.campaign = read_campaign_row(database);
  Statement all(database, fmt::format("SELECT {} FROM result", kColumns));
  while (all.step()) results.rows.push_back(read_row(all, path.string()));
  sort_rows(results);
  return results;
}

Results merged(const std::vector<std::filesystem::path>& paths) {
  Results all;
  std::map<std::pair<std::int64_t, std::string>, Result> rows;
  for (const std::filesystem::path& path : paths) {
    Results one = read_results(path);
    if (all.campaign.detectors.empty()) all.campaign = one.campaign;
    require_same(one.campaign, all.campaign, path.string(), paths.front().string());
    for (Result& row : one.rows) {
      const auto [at, is_new] = rows.try_emplace({row.run, row.detector}, row);
      if (is_new || at->second == row) continue;
      throw InputError(
          {.file = path.string(),
           .place = fmt::format("run {}, {}", row.run, row.detector),
           .found = "another result than in a file before it",
           .allowed = "one result for each run",
           .mend = "run all parts with one build of offnominal on one kind of machine"});
    }
  }
  for (auto& [key, row] : rows) all.rows.push_back(std::move(row));
  sort_rows(all);
  return all;
}

void write_results(const std::filesystem::path& path, const Results& results, Existing existing) {
  write_database(path, existing, [&](Database& database) {
    write_campaign_row(database, results.campaign);
    insert(database, results.rows);
  });
}

std::string run_list(const std::vector<std::int64_t>& numbers) {
  constexpr int kMost = 12;
  std::string text;
  int stretches = 0;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    if (++stretches > kMost) return text + ", ...";
    text += fmt::format("{}{}", text.empty() ? "" : ", ", numbers[i]);
    if (last > i) text += fmt::format(" to {}", numbers[last]);
    i = last + 1;
  }
  return text;
}

}  // namespace offnominal::desk::campaign
