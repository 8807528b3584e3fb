#include "tick_alone.hpp"

#include "tick_rig.hpp"

// One size: OFFNOMINAL_JOINTS, OFFNOMINAL_HIDDEN and OFFNOMINAL_SCALAR. `offnominal` is another
// name here (CMakeLists.txt), or the linker would keep one of two functions alike, this unit's or
// the one that it is compared with.

namespace tick_alone {
namespace {

class Alone : public Ticks {
 public:
  void step(std::size_t k) override { static_cast<void>(rig_.step(k)); }

 private:
  offnominal::bench::TickRig<OFFNOMINAL_JOINTS, OFFNOMINAL_HIDDEN, OFFNOMINAL_SCALAR> rig_{60,
                                                                                           true};
};

}  // namespace

std::unique_ptr<Ticks> OFFNOMINAL_TICKS() { return std::make_unique<Alone>(); }

}  // namespace tick_alone
