#include "arm_groups.hpp"

#include <array>

#include "case_seed.hpp"

namespace offnominal::bench {

namespace {

struct GroupRow {
  const char* name;
  const char* words;
  ArmHides hides;
  int cases;
  int quick;
};

constexpr std::array<GroupRow, 6> kGroups{{
    {"effects", "one to four effects", ArmHides::kEffects, 160, 8},
    {"no-friction", "no friction in the file", ArmHides::kNoFriction, 30, 2},
    {"payload", "a payload", ArmHides::kPayload, 40, 3},
    {"change", "a change in the middle", ArmHides::kChange, 45, 3},
    {"push", "a push", ArmHides::kPush, 25, 2},
    {"nothing", "nothing hidden", ArmHides::kNothing, 200, 6},
}};

}  // namespace

std::vector<ArmGroup> arm_groups(std::uint64_t base_seed, bool quick) {
  std::vector<ArmGroup> groups;
  for (const GroupRow& row : kGroups) {
    ArmGroup group{row.name, row.words, row.hides, {}};
    for (int i = 0; i < (quick ? row.quick : row.cases); ++i) {
      group.requests.push_back(
          {row.hides, case_seed(base_seed, std::string("arm ") + row.name, i)});
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace offnominal::bench
