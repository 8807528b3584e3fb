#include "campaign/run_campaign.hpp"

#include <limits>
#include <mutex>
#include <utility>
#include <vector>

#include "common/parallel.hpp"

namespace offnominal::desk::campaign {
namespace {

// Says how far it is, one thread at a time.
class Counter {
 public:
  Counter(std::string what, std::size_t of, const OnProgress& on_progress)
      : what_(std::move(what)), of_(static_cast<std::int64_t>(of)), on_progress_(on_progress) {
    if (on_progress_) on_progress_(what_, 0, of_);
  }
  // `first`: done before it is counted, by nobody else at that time.
  template <typename First>
  void count(const First& first) {
    const std::lock_guard lock(mutex_);
    first();
    ++done_;
    if (on_progress_) on_progress_(what_, done_, of_);
  }

 private:
  std::string what_;
  std::int64_t of_;
  std::int64_t done_ = 0;
  const OnProgress& on_progress_;
  std::mutex mutex_;
};

std::vector<Log> calibration_logs(const Campaign& campaign, const Simulator& simulator, int threads,
                                  const OnProgress& on_progress) {
  std::vector<Log> logs(static_cast<std::size_t>(campaign.calibration.runs));
  Counter counter("fault-free runs to calibrate on", logs.size(), on_progress);
  parallel_for(logs.size(), threads, [&](std::size_t i) {
    logs[i] = simulator.calibration_run(static_cast<int>(i));
    counter.count([] {});
  });
  return logs;
}

std::vector<std::unique_ptr<Detector>> calibrated_detectors(const Campaign& campaign,
                                                            const std::vector<Log>& logs,
                                                            int threads,
                                                            const OnProgress& on_progress) {
  std::vector<std::unique_ptr<Detector>> detectors(campaign.detectors.size());
  Counter counter("detectors calibrated", detectors.size(), on_progress);
  parallel_for(detectors.size(), threads, [&](std::size_t i) {
    detectors[i] = calibrated(campaign.detectors[i], campaign, logs);
    counter.count([] {});
  });
  return detectors;
}

}  // namespace

CalibratedCampaign::CalibratedCampaign(const Campaign& campaign, int threads,
                                       const OnProgress& on_progress)
    : campaign_(campaign), simulator_(campaign) {
  const std::vector<Log> logs = calibration_logs(campaign, simulator_, threads, on_progress);
  detectors_ = calibrated_detectors(campaign, logs, threads, on_progress);
}

CampaignRow CalibratedCampaign::row() const {
  CampaignRow row{campaign_.name, campaign_.identity, campaign_.run_count(), {}};
  for (std::size_t i = 0; i < detectors_.size(); ++i) {
    std::string notes;
    for (const std::string& note : detectors_[i]->notes()) {
      notes += (notes.empty() ? "" : "\n") + note;
    }
    row.detectors.push_back({campaign_.detectors[i].name, detectors_[i]->thresholds(), notes});
  }
  return row;
}

std::vector<Result> CalibratedCampaign::run(std::int64_t number) const {
  const Run run = run_of(campaign_, number);
  const RecordedRun recorded = simulator_.run(run);
  std::vector<Result> rows;
  for (std::size_t i = 0; i < detectors_.size(); ++i) {
    rows.push_back(score_of(campaign_, run, recorded, campaign_.detectors[i].name,
                            detectors_[i]->judge(recorded.log)));
    const std::unique_ptr<Accommodation> loop =
        run.fault == nullptr ? nullptr : detectors_[i]->accommodation();
    if (!loop) continue;
    const RecordedRun with = simulator_.accommodated(run, recorded, *loop);
    rows.back().tracking_end_accommodated_rad =
        with.ran_away_s ? std::numeric_limits<double>::infinity() : with.tracking_end_rad;
  }
  return rows;
}

RunOutcome run_campaign(const Campaign& campaign, const RunRequest& request,
                        const OnProgress& on_progress) {
  ResultFile::check(request.output, campaign);
  const CalibratedCampaign ready(campaign, request.threads, on_progress);
  ResultFile file = ResultFile::open(request.output, ready.row());
  const std::vector<std::int64_t> shard = runs_of(campaign, request.shard);
  RunOutcome outcome{static_cast<std::int64_t>(shard.size()), 0};
  const std::vector<std::int64_t> numbers = file.missing_of(shard);
  outcome.skipped = outcome.runs - static_cast<std::int64_t>(numbers.size());
  Counter counter("runs", numbers.size(), on_progress);
  parallel_for(numbers.size(), request.threads, [&](std::size_t i) {
    const std::vector<Result> rows = ready.run(numbers[i]);
    counter.count([&] { file.add(rows); });
  });
  return outcome;
}

}  // namespace offnominal::desk::campaign
