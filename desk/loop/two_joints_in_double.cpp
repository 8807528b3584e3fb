#include "loop/stepped_controller_impl.hpp"

namespace offnominal::desk::detail {

template std::unique_ptr<SteppedController> make_stepped_controller_of<2, double>(
    const SteppedSetup&);

}  // namespace offnominal::desk::detail
