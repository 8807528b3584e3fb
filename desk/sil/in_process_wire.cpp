#include <offnominal/hal/bus/in_process_bus.hpp>

#include "sil/wire.hpp"

namespace offnominal::desk::sil {
namespace {

class InProcessWire final : public Wire {
 public:
  BusPort& controller() override { return controller_; }
  BusPort& plant() override { return plant_; }
  void set_time(hal::Microseconds now_us) override { net_.set_time(now_us); }

 private:
  using Net = hal::InProcessNet<2, 1024>;

  Net net_;
  BusPortOf<Net::Port> controller_{net_.port(0)};
  BusPortOf<Net::Port> plant_{net_.port(1)};
};

}  // namespace

std::unique_ptr<Wire> make_in_process_wire() { return std::make_unique<InProcessWire>(); }

}  // namespace offnominal::desk::sil
