#include "studio/spans.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "common/plain_words.hpp"
#include "explain/data_fault.hpp"

namespace offnominal::desk::studio {
namespace {

using Eigen::Index;
using report::Level;
using report::SpanMark;

// More are no picture.
constexpr std::size_t kMostRests = 200;

class Spans {
 public:
  Spans(const Workbench& bench, const View& view)
      : now_(recording_of(bench.now(), view.recording)),
        joint_(static_cast<Index>(view.joint)),
        recording_(view.recording),
        is_fitted_(view.recording < bench.input().recordings->logs.size()) {}

  void take_faults(const std::vector<DataFault>& faults) {
    for (const DataFault& fault : faults) {
      if (fault.file != now_.file || (fault.joint >= 0 && fault.joint != joint_)) continue;
      for (const FaultSpan& span : fault.spans) {
        put(span.from_s, span.to_s, in_words(name_of(fault.kind)),
            fault.certain ? Level::kBad : Level::kWarn);
      }
    }
  }

  // Where nothing else leaves the samples out.
  void take_rests() {
    std::vector<SpanMark> rests;
    const Index count = now_.t_s.size();
    for (Index first = 0; first < count; ++first) {
      if (now_.moving(first, joint_) > 0) continue;
      Index last = first;
      while (last + 1 < count && !(now_.moving(last + 1, joint_) > 0)) ++last;
      const SpanMark rest{now_.t_s[first], now_.t_s[last], "not judged: at rest or at fault"};
      if (rest.from < rest.to) rests.push_back(rest);
      first = last;
    }
    std::stable_sort(rests.begin(), rests.end(), [](const SpanMark& a, const SpanMark& b) {
      return a.to - a.from > b.to - b.from;
    });
    if (rests.size() > kMostRests) rests.resize(kMostRests);
    std::sort(rests.begin(), rests.end(),
              [](const SpanMark& a, const SpanMark& b) { return a.from < b.from; });
    spans_.insert(spans_.end(), rests.begin(), rests.end());
  }

  void take_found(const Explanation& explanation) {
    for (const Push& push : explanation.pushes) {
      const bool shows = std::any_of(push.joints.begin(), push.joints.end(),
                                     [&](const auto& on) { return on.joint == joint_; });
      if (push.file == now_.file && shows) {
        put(push.from_s, push.to_s, "pushed from outside", Level::kWarn);
      }
    }
    if (!is_fitted_) return;
    for (const Change& change : explanation.changes) {
      if (change.is_between || change.recording != recording_) continue;
      if (!shows_on(change.what, joint_)) continue;
      put(change.at_s, change.until_s.value_or(now_.t_s[now_.t_s.size() - 1]),
          "changed: " + in_words(name_seen_from(joint_, change.what)), Level::kWarn);
    }
    for (const LoudSpan& loud : explanation.loud) {
      if (loud.recording != recording_ || loud.joint != joint_) continue;
      put(loud.from_s, loud.to_s, "the error stands out", Level::kNeutral);
    }
  }

  [[nodiscard]] std::vector<SpanMark> take() { return std::move(spans_); }

 private:
  void put(double from_s, double to_s, const std::string& label, Level level) {
    // One sample is a span, too.
    spans_.push_back({from_s, std::max(to_s, from_s + now_.plan.period_s()), label, level});
  }

  const Comparison& now_;
  Index joint_;
  std::size_t recording_;
  bool is_fitted_;
  std::vector<SpanMark> spans_;
};

}  // namespace

std::vector<SpanMark> spans_of(const Workbench& bench, const View& view,
                               const Explanation* explanation) {
  check(bench, view);
  Spans spans(bench, view);
  spans.take_rests();
  spans.take_faults(bench.input().recordings->faults);
  if (explanation != nullptr) spans.take_found(*explanation);
  return spans.take();
}

}  // namespace offnominal::desk::studio
