#include "paper/closed_loop_impl.hpp"

namespace offnominal::desk::paper {

OFFNOMINAL_INSTANTIATE_CLOSED_LOOP(35, double);
OFFNOMINAL_INSTANTIATE_CLOSED_LOOP(64, double);
OFFNOMINAL_INSTANTIATE_CLOSED_LOOP(128, double);
OFFNOMINAL_INSTANTIATE_CLOSED_LOOP(256, double);

}  // namespace offnominal::desk::paper
