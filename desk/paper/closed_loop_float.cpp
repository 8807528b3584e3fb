#include "paper/closed_loop_impl.hpp"

namespace offnominal::desk::paper {

OFFNOMINAL_INSTANTIATE_CLOSED_LOOP(35, float);
OFFNOMINAL_INSTANTIATE_CLOSED_LOOP(64, float);
OFFNOMINAL_INSTANTIATE_CLOSED_LOOP(128, float);
OFFNOMINAL_INSTANTIATE_CLOSED_LOOP(256, float);

}  // namespace offnominal::desk::paper
