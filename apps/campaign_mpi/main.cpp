// offnominal-campaign-mpi: a campaign on all processes of an `mpirun`. Rank 0 hands out one run
// after the other and writes all results; the others run what they are given.
#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <iostream>
#include <string>
#include <vector>

#include "campaign/campaign_file.hpp"
#include "campaign/result_file.hpp"
#include "campaign/result_numbers.hpp"
#include "campaign/run_campaign.hpp"
#include "campaign/summary.hpp"
#include "campaign/summary_report.hpp"
#include "campaign_mpi/mpi_world.hpp"
#include "common/error.hpp"

namespace offnominal::desk {
namespace {

struct MpiOptions {
  std::string file;
  std::string output;
};

// Rows of one run as one message, and back.
std::vector<double> message_of(const campaign::Campaign& plan,
                               const std::vector<campaign::Result>& rows) {
  std::vector<double> all;
  for (const campaign::Result& row : rows) {
    const std::vector<double> one = campaign::numbers_of(plan, row);
    all.insert(all.end(), one.begin(), one.end());
  }
  return all;
}

std::vector<campaign::Result> rows_of(const campaign::Campaign& plan,
                                      const std::vector<double>& message) {
  const std::size_t length = message.size() / plan.detectors.size();
  std::vector<campaign::Result> rows;
  for (std::size_t i = 0; i < plan.detectors.size(); ++i) {
    const auto begin = message.begin() + static_cast<std::ptrdiff_t>(i * length);
    rows.push_back(campaign::result_of(
        plan, std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(length))));
  }
  return rows;
}

// An empty message asks for the first run; a number below 0 is the end.
void work(const MpiWorld& world, const campaign::Campaign& plan,
          const campaign::CalibratedCampaign& ready) {
  std::vector<double> done;
  for (;;) {
    world.send(0, done);
    const std::vector<double> given = world.receive_from(0).numbers;
    if (given.at(0) < 0) return;
    done = message_of(plan, ready.run(static_cast<std::int64_t>(given[0])));
  }
}

void hand_out(const MpiWorld& world, const campaign::Campaign& plan,
              const campaign::CalibratedCampaign& ready, const std::string& output) {
  campaign::ResultFile file = campaign::ResultFile::open(output, ready.row());
  const std::vector<std::int64_t> all = file.missing_of(runs_of(plan, {}));
  std::deque<std::int64_t> numbers(all.begin(), all.end());
  if (world.size() == 1) {
    for (const std::int64_t run : numbers) file.add(ready.run(run));
    return;
  }
  for (int working = world.size() - 1; working > 0;) {
    const MpiWorld::Message message = world.receive();
    if (!message.numbers.empty()) file.add(rows_of(plan, message.numbers));
    if (numbers.empty()) {
      world.send(message.from, {-1});
      --working;
      continue;
    }
    world.send(message.from, {static_cast<double>(numbers.front())});
    numbers.pop_front();
  }
}

// Wrong inputs are found by rank 0 before anybody computes. False: they were, and it said so.
bool run(const MpiWorld& world, const MpiOptions& options) {
  std::string refusal;
  if (world.rank() == 0) {
    try {
      campaign::ResultFile::check(options.output, campaign::read_campaign(options.file));
    } catch (const InputError& error) {
      refusal = error.what();
    }
  }
  refusal = world.from_first(refusal);
  if (!refusal.empty()) {
    if (world.rank() == 0) std::cerr << refusal << std::endl;
    return false;
  }
  const campaign::Campaign plan = campaign::read_campaign(options.file);
  const campaign::CalibratedCampaign ready(plan, 1, {});
  if (world.rank() != 0) {
    work(world, plan, ready);
    return true;
  }
  hand_out(world, plan, ready, options.output);
  std::cout << text_of(summary_of(campaign::read_results(options.output)))
            << "written: " << options.output << '\n';
  return true;
}

int run_all(int argc, char** argv) {
  constexpr int kBadInput = 2;
  const MpiWorld world(argc, argv);
  CLI::App app{"A fault campaign on all processes of an mpirun (docs/campaigns.md)",
               "offnominal-campaign-mpi"};
  MpiOptions options;
  app.add_option("FILE", options.file, "Campaign file")->required();
  app.add_option("-o,--output", options.output,
                 "Results, an SQLite file; one of the same campaign is gone on with")
      ->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (world.rank() != 0) return error.get_exit_code() == 0 ? 0 : kBadInput;
    return app.exit(error) == 0 ? 0 : kBadInput;
  }
  try {
    return run(world, options) ? 0 : kBadInput;
  } catch (const std::exception& error) {
    // The others wait for this one.
    std::cerr << "rank " << world.rank() << ": " << on_one_line(error.what()) << std::endl;
    world.abort(kBadInput);
  }
}

}  // namespace
}  // namespace offnominal::desk

int main(int argc, char** argv) { return offnominal::desk::run_all(argc, argv); }
