#include "explain/given_part.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "common/error.hpp"

namespace offnominal::desk {

using Eigen::VectorXd;

std::optional<TimeSpan> part_that_may_differ(const std::vector<Log>& logs,
                                             const ExplainOptions& options) {
  if (options.after > 0) {
    TimeSpan part;
    for (std::size_t i = 0; i < logs.size(); ++i) {
      if (i >= options.after) {
        part.files.push_back(logs[i].file);
      } else if (std::any_of(logs.begin() + static_cast<std::ptrdiff_t>(options.after), logs.end(),
                             [&](const Log& after) { return after.file == logs[i].file; })) {
        throw InputError({"--after", "", logs[i].file + ", which is before too",
                          "recordings of other names", "give each once"});
      }
    }
    if (part.files.empty()) {
      throw InputError({"--after", "", "nothing", "one recording or more", ""});
    }
    return part;
  }
  if (!options.since_s) return std::nullopt;
  if (logs.size() != 1) {
    throw InputError({"--since", "", fmt::format("{} recordings", logs.size()),
                      "a time of the only recording",
                      "give what was recorded before and after with --before and --after"});
  }
  const VectorXd& t_s = logs.front().t_s;
  if (!(*options.since_s > t_s[0] && *options.since_s < t_s[t_s.size() - 1])) {
    throw InputError({"--since", "", fmt::format("{:g} s", *options.since_s),
                      fmt::format("a time stamp between {:g} and {:g} s, the ends of {}", t_s[0],
                                  t_s[t_s.size() - 1], logs.front().file),
                      ""});
  }
  return TimeSpan{{logs.front().file}, *options.since_s};
}

}  // namespace offnominal::desk
