#include "exchange/dh_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <set>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/input_name.hpp"
#include "common/nearest.hpp"
#include "common/number.hpp"
#include "common/toml_table.hpp"
#include "log/csv_log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::exchange {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kLargest = 1e5;  // further out no robot file takes a length
const std::vector<std::string> kConventions{"standard", "modified"};
const std::vector<std::string> kParameters{"a_m", "alpha_rad", "alpha_deg",
                                           "d_m", "theta_rad", "theta_deg"};

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& place,
                         const std::string& found, const std::string& allowed,
                         const std::string& mend) {
  throw InputError({path.string(), place, found, allowed, mend});
}

// The key of an angle that is there: "alpha_rad" or "alpha_deg", one of them.
template <typename Has, typename Refuse>
std::string angle_key(const std::string& angle, const Has& has, const Refuse& refuse_it) {
  const std::string rad = angle + "_rad";
  const std::string deg = angle + "_deg";
  if (has(rad) == has(deg)) {
    refuse_it(has(rad) ? fmt::format("both {} and {}", rad, deg)
                       : fmt::format("neither {} nor {}", rad, deg),
              "one of them", has(rad) ? "remove one" : fmt::format("add {} or {}", rad, deg));
  }
  return has(rad) ? rad : deg;
}

double in_radians(double value, const std::string& key) {
  return key.ends_with("_deg") ? value * kDegree : value;
}

DhConvention settled(const std::filesystem::path& path, std::optional<DhConvention> in_file,
                     std::optional<DhConvention> asked) {
  if (in_file && asked && *in_file != *asked) {
    refuse(path, "convention",
           fmt::format("{}, and --convention {}", name_of(*in_file), name_of(*asked)),
           "one convention", "correct one of them");
  }
  if (in_file) return *in_file;
  if (asked) return *asked;
  refuse(path, "", "no word on whether the table is a standard or a modified one",
         choice_of(kConventions),
         "add --convention modified where joint i turns about z of frame i (Craig), --convention "
         "standard where about z of frame i-1");
}

std::string in_small_letters(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// Many tables write a, alpha, d, theta, and do not say in what.
std::string mend_name(const std::string& name, const std::vector<std::string>& known) {
  const std::string small = in_small_letters(name);
  if (small == "a" || small == "d" || small == "r") {
    return fmt::format("name it {}, in metres", small == "d" ? "d_m" : "a_m");
  }
  if (small == "alpha" || small == "theta") {
    return fmt::format("name it {0}_deg where it is in degrees, {0}_rad where in radians", small);
  }
  const std::string meant = nearest(name, known);
  return meant.empty() ? "remove it" : fmt::format("name it {}", meant);
}

DhRow row_of(const TomlTable& table, std::size_t index) {
  DhRow row;
  row.name = table.has("name") ? table.text("name") : fmt::format("joint{}", index + 1);
  const bool slides = table.has("type") && table.choice("type", {"revolute", "prismatic"}) == 1;
  row.type = slides ? JointType::kPrismatic : JointType::kRevolute;
  row.a_m = table.number("a_m", physical(any_number("m")));
  row.d_m = table.number("d_m", physical(any_number("m")));
  const auto angle = [&](const char* name) {
    const std::string key = angle_key(
        name, [&](const std::string& one) { return table.has(one); },
        [&](const auto&... words) { table.refuse("", words...); });
    NumberRule rule = any_number(key.ends_with("_deg") ? "deg" : "rad");
    rule.largest = kLargest;
    return in_radians(table.number(key, rule), key);
  };
  row.alpha_rad = angle("alpha");
  row.theta_rad = angle("theta");
  return row;
}

DhTable read_toml(const std::filesystem::path& path, std::optional<DhConvention> convention) {
  const toml::table document = parse_toml(read_text_file(path), path.string());
  const TomlTable root(path.string(), "", document, {"convention", "joint"});
  std::optional<DhConvention> in_file;
  if (root.has("convention")) {
    in_file = static_cast<DhConvention>(root.choice("convention", kConventions));
  }
  std::vector<std::string> keys{"name", "type"};
  keys.insert(keys.end(), kParameters.begin(), kParameters.end());
  DhTable table{settled(path, in_file, convention), {}};
  std::set<std::string> names;
  for (const TomlTable& joint : root.tables("joint", keys)) {
    table.rows.push_back(row_of(joint, table.rows.size()));
    if (names.insert(table.rows.back().name).second) continue;
    joint.refuse("name", fmt::format("the name \"{}\" a second time", table.rows.back().name),
                 "names that differ", "give this joint another name");
  }
  return table;
}

// In words for a table, not for a recording.
void require_text(const std::filesystem::path& path) {
  if (!read_text_file(path).empty()) return;
  refuse(path, "", "an empty file", "a DH table, as CSV or as .toml",
         "begin with a line such as a_m,alpha_deg,d_m,theta_deg");
}

// Where the rows are counted, as tables have it, from 0 or 1: a row stands where its joint does.
// Names of joints in that column say nothing.
void check_count(const std::filesystem::path& path, const NamedColumns& read, Eigen::Index row) {
  const auto found = read.columns.find("joint");
  if (found == read.columns.end() || found->second.size() == 0) return;
  const double number = found->second[row];
  const double expected = (found->second[0] == 0 ? 0.0 : 1.0) + static_cast<double>(row);
  if (!std::isfinite(number) || number == expected) return;
  refuse(path, fmt::format("{}, column joint", read.place_of(row)), shortest(number),
         shortest(expected) + ", as the rows stand from the base outwards",
         "put the rows in the order of the joints");
}

DhTable read_csv_table(const std::filesystem::path& path, std::optional<DhConvention> convention) {
  std::vector<std::string> known = kParameters;
  known.insert(known.end(), {"prismatic"});
  if (!is_stream(path.string())) require_text(path);
  const NamedColumns read = read_csv(path, [&](const std::string& name) {
    const bool is_known = std::find(known.begin(), known.end(), name) != known.end();
    if (name == "joint") return Need::kWelcome;
    return is_known ? Need::kRequired : Need::kNone;
  });
  for (const std::string& name : read.names) {
    if (read.columns.contains(name) || name == "joint") continue;
    refuse(path, "column " + name, "a column that is none of a DH table", list_of(known),
           mend_name(name, known));
  }
  const auto has = [&](const std::string& name) { return read.columns.contains(name); };
  for (const char* name : {"a_m", "d_m"}) {
    if (!has(name)) refuse(path, "", fmt::format("no column {}", name), "one", "add it, in metres");
  }
  const auto key_of = [&](const char* angle) {
    return angle_key(angle, has, [&](const auto&... words) { refuse(path, "", words...); });
  };
  const std::string alpha = key_of("alpha");
  const std::string theta = key_of("theta");
  DhTable table{settled(path, std::nullopt, convention), {}};
  for (Eigen::Index i = 0; i < read.columns.at("a_m").size(); ++i) {
    const auto cell = [&](const std::string& name) {
      const double value = read.columns.at(name)[i];
      if (std::fabs(value) <= kLargest) return value;
      refuse(path, fmt::format("{}, column {}", read.place_of(i), name),
             std::isfinite(value) ? shortest(value) : "no finite number",
             fmt::format("a number of at most {}", shortest(kLargest)),
             std::isfinite(value) ? "check the unit" : "write 0 where there is nothing");
    };
    check_count(path, read, i);
    DhRow row;
    row.name = fmt::format("joint{}", i + 1);
    if (has("prismatic") && cell("prismatic") != 0) {
      if (cell("prismatic") != 1) {
        refuse(path, fmt::format("{}, column prismatic", read.place_of(i)),
               shortest(cell("prismatic")), "0 or 1", "write 1 where the joint slides, else 0");
      }
      row.type = JointType::kPrismatic;
    }
    row.a_m = cell("a_m");
    row.d_m = cell("d_m");
    row.alpha_rad = in_radians(cell(alpha), alpha);
    row.theta_rad = in_radians(cell(theta), theta);
    table.rows.push_back(row);
  }
  return table;
}

}  // namespace

const char* name_of(DhConvention convention) {
  return convention == DhConvention::kStandard ? "standard" : "modified";
}

DhTable read_dh_table(const std::filesystem::path& path, std::optional<DhConvention> convention) {
  const bool is_toml = in_small_letters(path.extension().string()) == ".toml";
  DhTable table = is_toml ? read_toml(path, convention) : read_csv_table(path, convention);
  if (table.rows.empty() || table.rows.size() > static_cast<std::size_t>(kMaxJoints)) {
    refuse(path, "", fmt::format("{} joints", table.rows.size()),
           fmt::format("1 to {}, a row each", kMaxJoints),
           table.rows.empty() ? "write a row for each joint" : "leave out what no drive moves");
  }
  return table;
}

}  // namespace offnominal::desk::exchange
