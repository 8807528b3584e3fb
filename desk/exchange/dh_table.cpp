#include "exchange/dh_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/input_name.hpp"
#include "common/nearest.hpp"
#include "common/number.hpp"
#include "common/small_letters.hpp"
#include "common/toml_table.hpp"
#include "exchange/angle_text.hpp"
#include "log/csv_log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::exchange {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kLargest = 1e5;  // further out no robot file takes a length
const std::vector<std::string> kConventions{"standard", "modified"};
const std::vector<std::string> kParameters{"a_m", "a_mm", "alpha_rad", "alpha_deg",
                                           "d_m", "d_mm", "theta_rad", "theta_deg"};

// One of the four numbers of a row, which stands in the one unit or in the other.
struct Parameter {
  const char* name;
  const char* unit;   // of the SI
  const char* other;  // of the same
  double factor;      // from that one
  // Beyond it, it is the other unit's number by its size.
  double largest;
};
constexpr double kTurn = 2 * std::numbers::pi + 1e-3;
// No link of an arm is longer, and hardly a table in mm has none that is.
constexpr double kLongest = 20;
constexpr Parameter kA{"a", "m", "mm", 1e-3, kLongest};
constexpr Parameter kAlpha{"alpha", "rad", "deg", kDegree, kTurn};
constexpr Parameter kD{"d", "m", "mm", 1e-3, kLongest};
constexpr Parameter kTheta{"theta", "rad", "deg", kDegree, kTurn};

bool is_angle(const Parameter& parameter) { return parameter.factor == kDegree; }

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& place,
                         const std::string& found, const std::string& allowed,
                         const std::string& mend) {
  throw InputError({path.string(), place, found, allowed, mend});
}

// The key of the parameter that is there: "alpha_rad" or "alpha_deg", one of them.
template <typename Has, typename Refuse>
std::string key_of(const Parameter& parameter, const Has& has, const Refuse& refuse_it) {
  const std::string si = fmt::format("{}_{}", parameter.name, parameter.unit);
  const std::string other = fmt::format("{}_{}", parameter.name, parameter.other);
  if (has(si) == has(other)) {
    refuse_it(has(si) ? fmt::format("both {} and {}", si, other)
                      : fmt::format("neither {} nor {}", si, other),
              "one of them", has(si) ? "remove one" : fmt::format("add {} or {}", si, other));
  }
  return has(si) ? si : other;
}

// What stands under `key`, in SI units. A number that the unit of the name makes nothing of an arm
// is refused.
template <typename Refuse>
double in_si(const Parameter& parameter, double value, const std::string& key,
             const Refuse& refuse_it) {
  if (key.ends_with(std::string("_") + parameter.other)) return value * parameter.factor;
  if (std::fabs(value) > parameter.largest) {
    refuse_it(fmt::format("{} {}, which is {} by its size", shortest(value), parameter.unit,
                          is_angle(parameter) ? "degrees" : "millimetres"),
              is_angle(parameter) ? "an angle of at most one turn, 2 pi"
                                  : fmt::format("a length of at most {} m", shortest(kLongest)),
              fmt::format("name it {0}_{1} where it is in {1}, or write it in {2}", parameter.name,
                          parameter.other, parameter.unit));
  }
  return value;
}

// Degrees that are radians by their size, and millimetres that are metres, are no error: they are
// told.
class UnitDoubts {
 public:
  void look_at(const Parameter& parameter, double value, const std::string& key) {
    if (!key.ends_with(std::string("_") + parameter.other) || value == 0) return;
    if (is_angle(parameter)) {
      const double quarters = std::fabs(value) / (std::numbers::pi / 2);
      const auto nearest_quarter = static_cast<std::size_t>(std::round(quarters));
      const bool is_of_radians = nearest_quarter > 0 && nearest_quarter <= kQuarters.size() &&
                                 std::fabs(quarters - std::round(quarters)) < kDigits;
      if (is_of_radians && said_.insert(key).second) {
        notes_.push_back(fmt::format(
            "{} = {} is {}{} as radians: name it {}_rad where that is meant", key, shortest(value),
            value < 0 ? "-" : "", kQuarters[nearest_quarter - 1], parameter.name));
      }
    } else {
      longest_mm_ = std::max(longest_mm_, std::fabs(value));
    }
  }

  std::vector<std::string> notes() {
    constexpr double kShortestArm = 2;  // mm
    if (longest_mm_ > 0 && longest_mm_ < kShortestArm) {
      notes_.push_back(
          fmt::format("no length is above {} mm: name them a_m and d_m where metres are meant",
                      shortest(longest_mm_)));
    }
    return std::move(notes_);
  }

 private:
  static constexpr double kDigits = 1e-3;
  static constexpr std::array kQuarters{"pi/2", "pi", "3 pi/2", "2 pi"};
  std::set<std::string> said_;
  std::vector<std::string> notes_;
  double longest_mm_ = 0;
};

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

// Many tables write a, alpha, d, theta, and do not say in what.
std::string mend_name(const std::string& name, const std::vector<std::string>& known) {
  const std::string small = in_small_letters(name);
  if (small == "a" || small == "d" || small == "r") {
    return fmt::format("name it {0}_m where it is in metres, {0}_mm where in millimetres",
                       small == "d" ? "d" : "a");
  }
  if (small == "alpha" || small == "theta") {
    return fmt::format("name it {0}_deg where it is in degrees, {0}_rad where in radians", small);
  }
  const std::string meant = nearest(name, known);
  return meant.empty() ? "remove it" : fmt::format("name it {}", meant);
}

// "pi/2", which is an angle in rad and nothing else; none where `text` is no such thing.
template <typename Refuse>
std::optional<double> angle_in(const std::string& key, const std::string& text,
                               const Refuse& refuse_it) {
  const std::optional<double> angle = share_of_pi(text);
  if (!angle || key.ends_with("_rad")) return angle;
  const bool is_in_deg = key.ends_with("_deg");
  refuse_it("\"" + text + "\", an angle in rad",
            is_in_deg ? "a number of degrees" : "a number, in " + key.substr(key.rfind('_') + 1),
            is_in_deg ? fmt::format("write {}, or name it {}_rad",
                                    shortest(std::round(*angle / kDegree * 1e9) / 1e9),
                                    key.substr(0, key.rfind('_')))
                      : "write the length");
  return angle;
}

// `raw`: the same table.
DhRow row_of(const TomlTable& table, const toml::table& raw, std::size_t index,
             UnitDoubts& doubts) {
  DhRow row;
  row.name = table.has("name") ? table.text("name") : fmt::format("joint{}", index + 1);
  const bool slides = table.has("type") && table.choice("type", {"revolute", "prismatic"}) == 1;
  row.type = slides ? JointType::kPrismatic : JointType::kRevolute;
  const auto number = [&](const Parameter& parameter) {
    const std::string key = key_of(
        parameter, [&](const std::string& one) { return table.has(one); },
        [&](const auto&... words) { table.refuse("", words...); });
    NumberRule rule = any_number(key.substr(key.rfind('_') + 1));
    rule.largest = kLargest;
    const auto refuse_it = [&](const auto&... words) { table.refuse(key, words...); };
    if (const auto text = raw[key].value<std::string>()) {
      const auto angle = angle_in(key, *text, refuse_it);
      if (angle) return in_si(parameter, *angle, key, refuse_it);
    }
    const double value = table.number(key, rule);
    doubts.look_at(parameter, value, key);
    return in_si(parameter, value, key, refuse_it);
  };
  row.a_m = number(kA);
  row.d_m = number(kD);
  row.alpha_rad = number(kAlpha);
  row.theta_rad = number(kTheta);
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
  DhTable table{settled(path, in_file, convention), {}, {}};
  UnitDoubts doubts;
  std::set<std::string> names;
  for (const TomlTable& joint : root.tables("joint", keys)) {
    const std::size_t index = table.rows.size();
    const toml::table& raw = *document["joint"][index].as_table();
    table.rows.push_back(row_of(joint, raw, index, doubts));
    if (names.insert(table.rows.back().name).second) continue;
    joint.refuse("name", fmt::format("the name \"{}\" a second time", table.rows.back().name),
                 "names that differ", "give this joint another name");
  }
  table.notes = doubts.notes();
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
  const auto is_known = [&](const std::string& name) {
    return std::find(known.begin(), known.end(), name) != known.end();
  };
  const NamedColumns read = read_csv(
      path,
      [&](const std::string& name) {
        if (name == "joint") return Need::kWelcome;
        return is_known(name) ? Need::kRequired : Need::kNone;
      },
      [&](const std::string& place, const std::string& column, const std::string& text) {
        const auto refuse_it = [&](const auto&... words) { refuse(path, place, words...); };
        return is_known(column) ? angle_in(column, text, refuse_it) : std::nullopt;
      });
  std::vector<std::string> allowed{"joint"};
  allowed.insert(allowed.end(), known.begin(), known.end());
  for (const std::string& name : read.names) {
    if (read.columns.contains(name) || name == "joint") continue;
    refuse(path, "column " + name, "a column that is none of a DH table", list_of(allowed),
           mend_name(name, allowed));
  }
  const auto has = [&](const std::string& name) { return read.columns.contains(name); };
  const auto column_of = [&](const Parameter& parameter) {
    return key_of(parameter, has, [&](const auto&... words) { refuse(path, "", words...); });
  };
  const std::string a = column_of(kA);
  const std::string d = column_of(kD);
  const std::string alpha = column_of(kAlpha);
  const std::string theta = column_of(kTheta);
  DhTable table{settled(path, std::nullopt, convention), {}, {}};
  UnitDoubts doubts;
  for (Eigen::Index i = 0; i < read.columns.at(a).size(); ++i) {
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
    const auto in_column = [&](const Parameter& parameter, const std::string& name) {
      const double value = cell(name);
      doubts.look_at(parameter, value, name);
      return in_si(parameter, value, name, [&](const auto&... words) {
        refuse(path, fmt::format("{}, column {}", read.place_of(i), name), words...);
      });
    };
    row.a_m = in_column(kA, a);
    row.d_m = in_column(kD, d);
    row.alpha_rad = in_column(kAlpha, alpha);
    row.theta_rad = in_column(kTheta, theta);
    table.rows.push_back(row);
  }
  table.notes = read.remarks;
  for (std::string& note : doubts.notes()) table.notes.push_back(std::move(note));
  return table;
}

}  // namespace

const char* name_of(DhConvention convention) {
  return convention == DhConvention::kStandard ? "standard" : "modified";
}

DhTable read_dh_table(const std::filesystem::path& path, std::optional<DhConvention> convention) {
  const bool is_toml = extension_of(path) == ".toml";
  DhTable table = is_toml ? read_toml(path, convention) : read_csv_table(path, convention);
  if (table.rows.empty() || table.rows.size() > static_cast<std::size_t>(kMaxJoints)) {
    refuse(path, "", fmt::format("{} joints", table.rows.size()),
           fmt::format("1 to {}, a row each", kMaxJoints),
           table.rows.empty() ? "write a row for each joint" : "leave out what no drive moves");
  }
  return table;
}

}  // namespace offnominal::desk::exchange
