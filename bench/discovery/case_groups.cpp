#include "case_groups.hpp"

#include <array>
#include <string_view>
#include <utility>

#include "case_seed.hpp"

namespace offnominal::bench {

using sim::hidden::DataFault;
using sim::hidden::Excitation;
using sim::hidden::HiddenEffect;
using sim::hidden::Request;

namespace {

using Kind = CaseGroup::Kind;

// Effects are taken in blocks of the simulator's table, each with case numbers of its own: one that
// is added at its end leaves every other case as it was.
constexpr std::size_t kBlock = 20;
constexpr int kNumbersOfABlock = 1'000'000;

std::vector<std::vector<HiddenEffect>> effect_blocks() {
  std::vector<std::vector<HiddenEffect>> blocks;
  for (const HiddenEffect effect : sim::hidden::all_hidden_effects()) {
    if (blocks.empty() || blocks.back().size() == kBlock) blocks.emplace_back();
    blocks.back().push_back(effect);
  }
  return blocks;
}

CaseGroup start(std::string name, std::string words, Kind kind, std::uint64_t base, int count) {
  CaseGroup group{std::move(name), std::move(words), kind, false, {}};
  for (int i = 0; i < count; ++i) {
    Request request;
    request.seed = case_seed(base, group.name, i);
    group.requests.push_back(request);
  }
  return group;
}

// Adds case `number` of block `block`.
Request& add_case(CaseGroup& group, std::uint64_t base, std::size_t block, int number) {
  Request request;
  request.seed = case_seed(base, group.name, static_cast<int>(block) * kNumbersOfABlock + number);
  return group.requests.emplace_back(std::move(request));
}

// Each effect alone, in turn.
CaseGroup one_effect(std::string name, std::string words, std::uint64_t base, int rounds) {
  CaseGroup group = start(std::move(name), std::move(words), Kind::kEffects, base, 0);
  const auto blocks = effect_blocks();
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    int number = 0;
    for (int round = 0; round < rounds; ++round) {
      for (const HiddenEffect effect : blocks[b]) {
        add_case(group, base, b, number++).effects = {effect};
      }
    }
  }
  return group;
}

CaseGroup none(std::string name, std::string words, std::uint64_t base, int count, double noise,
               int bits) {
  CaseGroup group = start(std::move(name), std::move(words), Kind::kNone, base, count);
  group.with_baselines = true;
  for (Request& request : group.requests) {
    request.torque_noise_share = noise;
    request.encoder_bits = bits;
  }
  return group;
}

// Pairs of the first block, then each effect of the others beside one that came before it.
CaseGroup two_effects(std::uint64_t base, int count, int rounds) {
  CaseGroup group = start("two", "two effects at once", Kind::kEffects, base, count);
  group.with_baselines = true;
  const auto all = sim::hidden::all_hidden_effects();
  for (Request& request : group.requests) {
    const std::uint64_t draw = split_mix(request.seed);
    const auto first = static_cast<std::size_t>(draw % kBlock);
    const auto step = 1 + static_cast<std::size_t>((draw >> 32U) % (kBlock - 1));
    request.effects = {all.at(first), all.at((first + step) % kBlock)};
  }
  for (std::size_t i = kBlock; i < all.size(); ++i) {
    for (int round = 0; round < rounds; ++round) {
      Request& request =
          add_case(group, base, i / kBlock,
                   static_cast<int>(i % kBlock + static_cast<std::size_t>(round) * kBlock));
      request.effects = {all[i], all[split_mix(request.seed) % i]};
    }
  }
  return group;
}

CaseGroup outside(std::uint64_t base, int rounds) {
  const auto all = sim::hidden::all_outside_effects();
  const auto kinds = static_cast<int>(all.size());
  CaseGroup group =
      start("outside", "effect outside of the list", Kind::kOutside, base, rounds * kinds);
  for (std::size_t i = 0; i < group.requests.size(); ++i) {
    group.requests[i].outside = all[i % all.size()];
  }
  return group;
}

CaseGroup data_faults(std::uint64_t base, int rounds) {
  constexpr std::array kFaults = {DataFault::kClockSkew, DataFault::kDegrees,
                                  DataFault::kSwappedTorqueSign, DataFault::kStaleSamples};
  CaseGroup group = start("faults", "fault of the recording", Kind::kDataFault, base,
                          rounds * static_cast<int>(kFaults.size()));
  for (std::size_t i = 0; i < group.requests.size(); ++i) {
    group.requests[i].fault = kFaults[i % kFaults.size()];
  }
  return group;
}

// One effect and a first motion that does not show which (motion_case.hpp): too little of it, and
// every second time too much alike.
CaseGroup motions(std::uint64_t base, int count, int rounds) {
  CaseGroup group =
      start("motion", "undecided, then a designed motion", Kind::kMotion, base, count);
  const auto blocks = effect_blocks();
  const auto hide = [&](Request& request, std::size_t block, std::size_t number) {
    const std::size_t effects = blocks[block].size();
    request.effects = {blocks[block][number % effects]};
    const bool poor = (number % effects + number / effects) % 2 == 0;
    request.excitation = poor ? Excitation::kPoor : Excitation::kRich;
  };
  for (std::size_t i = 0; i < group.requests.size(); ++i) hide(group.requests[i], 0, i);
  for (std::size_t b = 1; b < blocks.size(); ++b) {
    for (std::size_t i = 0; i < blocks[b].size() * static_cast<std::size_t>(rounds); ++i) {
      hide(add_case(group, base, b, static_cast<int>(i)), b, i);
    }
  }
  return group;
}

}  // namespace

std::vector<CaseGroup> case_groups(std::uint64_t base_seed, bool quick) {
  const auto count = [quick](int full, int short_form) { return quick ? short_form : full; };
  std::vector<CaseGroup> groups;
  groups.push_back(one_effect("single", "one effect", base_seed, count(20, 2)));
  groups.back().with_baselines = true;
  groups.push_back(none("none-0.2", "none, 0.2 % / 19 bit", base_seed, count(300, 6), 0.002, 19));
  groups.push_back(none("none-1", "none, 1 % / 16 bit", base_seed, count(300, 6), 0.01, 16));
  groups.push_back(none("none-3", "none, 3 % / 13 bit", base_seed, count(300, 6), 0.03, 13));
  groups.push_back(none("none-poor", "none, poor motion", base_seed, count(100, 6), 0.002, 19));
  for (Request& request : groups.back().requests) request.excitation = Excitation::kPoor;
  groups.push_back(one_effect("noisy", "one effect, 3 % / 13 bit", base_seed, count(5, 1)));
  for (Request& request : groups.back().requests) {
    request.torque_noise_share = 0.03;
    request.encoder_bits = 13;
  }
  groups.push_back(one_effect("small", "one effect at 0.4 of its size", base_seed, count(5, 1)));
  for (Request& request : groups.back().requests) request.effect_size = 0.4;
  groups.push_back(one_effect("poor", "one effect, poor motion", base_seed, count(5, 1)));
  for (Request& request : groups.back().requests) request.excitation = Excitation::kPoor;
  groups.push_back(two_effects(base_seed, count(100, 10), count(5, 1)));
  groups.push_back(outside(base_seed, count(20, 2)));
  groups.push_back(data_faults(base_seed, count(20, 2)));
  groups.push_back(motions(base_seed, count(50, 2), count(2, 0)));
  return groups;
}

}  // namespace offnominal::bench
