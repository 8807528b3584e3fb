#include "explain/change_words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

namespace offnominal::desk {
namespace {

std::string words_of_time(const Change& change) {
  if (change.is_between) return "from before to after";
  return change.until_s
             ? fmt::format("from {:.2f} to {:.2f} s of recording {}", change.at_s, *change.until_s,
                           change.recording + 1)
             : fmt::format("from {:.2f} s of recording {} on", change.at_s, change.recording + 1);
}

std::string advice_on(const Change& one) {
  // What is found beside a change holds all the time, and a robot file knows no other time.
  if (one.is_between) {
    return "the recordings before and after are of two robots: a robot file says one of them; "
           "leave the others out to fit or calibrate it";
  }
  return one.until_s ? fmt::format(
                           "recording {} from {:.4g} to {:.4g} s is of another robot, or of "
                           "something that holds it: leave that out to fit or calibrate the rest",
                           one.recording + 1, one.at_s, *one.until_s)
                     : fmt::format(
                           "recording {} before and behind {:.4g} s is of two robots: a robot file "
                           "says one of them; cut it there to fit or calibrate either",
                           one.recording + 1, one.at_s);
}

}  // namespace

std::string words_of(const Change& change) {
  std::vector<std::string> names{std::string(change.what.name())};
  for (const EffectAt& one : change.alike) {
    names.push_back(name_seen_from(change.what.joint, one));
  }
  std::vector<std::string> by;
  for (const Estimate& one : change.by) {
    const bool plain = one.value.unit.empty() || one.value.unit == "1";
    by.push_back(fmt::format("{} {:+.3g}{}", one.value.name, one.value.value,
                             plain ? "" : " " + one.value.unit));
  }
  return fmt::format("{} on joint {} {} ({})", fmt::join(names, " or "), change.what.joint + 1,
                     words_of_time(change), fmt::join(by, ", "));
}

std::vector<Change> changes_on(const Explanation& e, Eigen::Index joint) {
  std::vector<Change> own;
  std::copy_if(e.changes.begin(), e.changes.end(), std::back_inserter(own),
               [&](const Change& one) { return one.what.joint == joint; });
  return own;
}

std::string words_of(const std::vector<Change>& changes) {
  std::vector<std::string> all;
  std::transform(changes.begin(), changes.end(), std::back_inserter(all),
                 [](const Change& one) { return words_of(one); });
  return fmt::format("{}", fmt::join(all, "; "));
}

std::string sentence_on_changes(const Explanation& e) {
  if (!e.changes.empty()) {
    return fmt::format("The robot changes{}: {}.",
                       e.changes_between ? "" : " in the middle of a recording",
                       words_of(e.changes));
  }
  return e.changes_asked
             ? "No change is told there: neither a payload on the last link, nor Coulomb or "
               "viscous friction, a constant torque or a torque constant of any joint "
               "stands out. That does not say that none changed, the less the shorter "
               "the part behind it is."
             : "";
}

void advise_on_changes(Explanation& e) {
  for (const Change& one : e.changes) {
    std::string advice = advice_on(one);
    if (std::find(e.advice.begin(), e.advice.end(), advice) == e.advice.end()) {
      e.advice.push_back(std::move(advice));
    }
  }
}

}  // namespace offnominal::desk
