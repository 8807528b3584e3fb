#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace offnominal::desk {

// What a reader shall do with a column of a given name.
enum class Need {
  kRequired,   // a cell that is no number is an error
  kAscending,  // required, and time: what is read as it comes is read as far as it ascends
  kTime,       // a time, perhaps: left out where it has neither numbers nor dates
  kWelcome,    // left out where it is not numeric
  kNone,       // not read
};
inline bool is_required(Need need) { return need == Need::kRequired || need == Need::kAscending; }
using NeedOf = std::function<Need(const std::string& name)>;

// Where a column of time does not hold what its cells say, but what has passed since the first:
// dates, and numbers of which a double holds too few digits.
struct TimeOrigin {
  double value = 0;      // of the first cell, as near as a double is; s since 1970 for a date
  bool is_date = false;  // the column is then in s, whatever else is said of it
};

// The numbers of a recording as its file names them, before anything is known of joints.
struct NamedColumns {
  std::string file;
  std::vector<std::string> names;  // everything that the file has, in its order
  bool has_names = true;           // else they are the columns' numbers, from 1
  std::map<std::string, Eigen::VectorXd> columns;
  std::set<std::string> taken;  // names of `columns` that one quantity has used up, as the time
  std::map<std::string, double> scalars;
  std::map<std::string, std::string> units;  // that the file itself says, by name
  std::map<std::string, TimeOrigin> origins;
  std::vector<std::string> remarks;  // what a reader of results has to know, in words
  // Where row `row` (from 0) stands in the file: "line 12" or "sample 11".
  std::function<std::string(Eigen::Index row)> place_of;
};

}  // namespace offnominal::desk
