#include "identify/held_out_parts.hpp"

#include <algorithm>
#include <cstddef>

namespace offnominal::desk {

std::vector<int> held_out_parts(const RowLayout& layout, bool at_rest) {
  constexpr double kBlockS = 2;
  double block_s = kBlockS;
  if (!at_rest) {
    double whole_s = 0;
    for (std::size_t r = 0; r < layout.recording_count(); ++r) {
      whole_s += layout.period_s(r) * static_cast<double>(layout.samples(r));
    }
    block_s = std::min(kBlockS, whole_s / (2 * kHeldOutParts));
  }
  // What a short recording alone has, a change, is otherwise unseen as a whole.
  constexpr int kOfEachRecording = 2;
  std::vector<int> parts = layout.blocks(block_s, kOfEachRecording).of_row;
  for (int& part : parts) part %= kHeldOutParts;
  return parts;
}

}  // namespace offnominal::desk
