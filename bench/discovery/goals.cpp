#include "goals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace offnominal::bench {

namespace {

class Goals {
 public:
  explicit Goals(const std::vector<Summary>& lines) : lines_(lines) {}

  void at_least(const std::string& group, const std::string& what, Rate Summary::*rate,
                double percent) {
    add(group, what, rate, percent, 100.0, fmt::format(">= {} %", percent));
  }
  void at_most(const std::string& group, const std::string& what, Rate Summary::*rate,
               double percent) {
    add(group, what, rate, 0.0, percent,
        percent > 0 ? fmt::format("<= {} %", percent) : std::string("0"));
  }
  void between(const std::string& group, const std::string& what, Rate Summary::*rate, double low,
               double high) {
    add(group, what, rate, low, high, fmt::format("{} to {} %", low, high));
  }
  void time(double most_s) {
    double worst = 0;
    for (const Summary& line : lines_) worst = std::max(worst, line.worst_s);
    goals_.push_back({"time of a case, one thread, worst", fmt::format("<= {} s", most_s),
                      fmt::format("{:.1f} s", worst), worst <= most_s});
  }
  [[nodiscard]] std::vector<Goal> take() { return std::move(goals_); }

 private:
  void add(const std::string& group, const std::string& what, Rate Summary::*rate, double low,
           double high, std::string wanted) {
    for (const Summary& line : lines_) {
      if (line.group != group || line.method != "explain") continue;
      const Rate& found = line.*rate;
      const double percent = found.percent();
      goals_.push_back({line.words + ": " + what, std::move(wanted),
                        fmt::format("{:.1f} % ({} of {})", percent, found.hits, found.of),
                        found.of > 0 && percent >= low && percent <= high});
      return;
    }
  }

  const std::vector<Summary>& lines_;
  std::vector<Goal> goals_;
};

}  // namespace

std::vector<Goal> goals_of(const std::vector<Summary>& lines) {
  Goals goals(lines);
  goals.at_least("single", "named first", &Summary::first, 95);
  goals.at_least("single", "named or within the class", &Summary::in_class, 99);
  goals.at_least("single", "all parameters within 10 %", &Summary::all_parameters, 90);
  goals.between("single", "95 % intervals cover", &Summary::covered, 90, 99);
  goals.at_least("single", "hold-out error <= 1.2 x noise floor", &Summary::holdout, 95);
  for (const char* group : {"none-0.2", "none-1", "none-3", "none-poor"}) {
    goals.at_most(group, "false discoveries", &Summary::wrong, 0);
  }
  for (const char* group : {"noisy", "small", "poor"}) {
    goals.at_least(group, "named or within the class", &Summary::in_class, 90);
    goals.at_least(group, "or undecided, and nothing wrong", &Summary::class_or_undecided, 100);
  }
  goals.at_most("poor", "wrong found", &Summary::wrong, 1);
  goals.at_least("two", "both named", &Summary::all_named, 85);
  goals.at_least("outside", "verdict unknown", &Summary::right_verdict, 90);
  goals.at_least("outside", "right variable", &Summary::right_detail, 80);
  goals.at_most("outside", "wrong found", &Summary::wrong, 5);
  goals.at_least("faults", "verdict data_fault", &Summary::right_verdict, 100);
  goals.at_least("faults", "right fault", &Summary::right_detail, 100);
  goals.at_least("motion", "resolved by the designed motion", &Summary::sure, 90);
  goals.time(10);
  return goals.take();
}

}  // namespace offnominal::bench
