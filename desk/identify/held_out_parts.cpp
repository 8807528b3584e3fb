#include "identify/held_out_parts.hpp"

namespace offnominal::desk {

std::vector<int> held_out_parts(const RowLayout& layout) {
  constexpr double kBlockS = 2;
  std::vector<int> parts = layout.blocks(kBlockS).of_row;
  for (int& part : parts) part %= kHeldOutParts;
  return parts;
}

}  // namespace offnominal::desk
