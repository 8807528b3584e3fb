#include "paper/closed_loop_impl.hpp"

namespace offnominal::desk::paper {

OFFNOMINAL_INSTANTIATE_CLOSED_LOOP(kPaperHiddenUnits, float);
OFFNOMINAL_INSTANTIATE_CLOSED_LOOP(kMaxHiddenUnits, float);

}  // namespace offnominal::desk::paper
