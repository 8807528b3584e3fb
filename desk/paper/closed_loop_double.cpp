#include "paper/closed_loop_impl.hpp"

namespace offnominal::desk::paper {

OFFNOMINAL_INSTANTIATE_CLOSED_LOOP(kPaperHiddenUnits, double);
OFFNOMINAL_INSTANTIATE_CLOSED_LOOP(kMaxHiddenUnits, double);

}  // namespace offnominal::desk::paper
