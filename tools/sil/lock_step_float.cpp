#include "sil/lock_step_impl.hpp"

namespace offnominal::tools::sil {

template void run_loop<float>(const RobotDescription&, const Scenario&, const LoopSetup&, Wire&,
                              const TappedPort::OnFrame&, const paper::TickObserver&, SilResult&);

}  // namespace offnominal::tools::sil
