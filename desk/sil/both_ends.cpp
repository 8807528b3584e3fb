#include "sil/both_ends.hpp"

#include <string>

#include "common/error.hpp"
#include "loop/refusal_words.hpp"
#include "sil/plant_of.hpp"

namespace offnominal::desk::sil {
namespace {

ControllerSettings settings_of(const Scenario& scenario) {
  ControllerSettings settings;
  static_cast<ActSettings&>(settings) = static_cast<const ActSettings&>(scenario);
  settings.accommodate = scenario.accommodate;
  if (!scenario.sends_velocity) settings.max_acceleration = scenario.max_acceleration;
  settings.encoder_bits_per_turn = scenario.encoder_bits_per_turn;
  return settings;
}

}  // namespace

BothEnds::BothEnds(const RobotDescription& robot, const Scenario& scenario, Wire& wire,
                   const TappedPort::OnFrame& on_frame)
    : period_us_(period_us_of(robot.estimator.period_s)),
      robot_(robot),
      motion_(motion_of(scenario)),
      wire_(wire),
      controller_tap_(wire.controller(), on_frame),
      plant_tap_(wire.plant(), on_frame),
      plant_(plant_of(scenario, robot.drive_settings(), robot.estimator.period_s)),
      controller_bus_(controller_tap_, sim::BusEnd::kController, plant_.drives(), scenario.faults,
                      scenario.seed),
      plant_bus_(plant_tap_, sim::BusEnd::kPlant, plant_.drives(), scenario.faults, scenario.seed),
      controller_(make_stepped_controller(
          {.robot = robot,
           .settings = settings_of(scenario),
           .link = {period_us_,
                    format_of(scenario, robot.drive_settings(), robot.estimator.period_s)},
           .motion = motion_},
          scenario.precision)) {}

void BothEnds::start() {
  constexpr int kPatience = 200;
  controller::Fault refusal = controller::Fault::kNotPassive;
  for (int i = 0; i < kPatience && passes_by_itself(refusal); ++i) {
    tick();
    refusal = controller_->arm();
  }
  if (refusal == controller::Fault::kNone) return;
  const bool unheard = passes_by_itself(refusal);
  throw InputError(
      {.file = "sil",
       .place = "start",
       .found = unheard ? "no valid frames of every joint within 200 ticks"
                        : std::string("arming refused: ") + controller::name_of(refusal),
       .allowed = "",
       .mend = unheard ? "let the faults on the bus begin later" : mend_of(refusal, robot_)});
}

void BothEnds::tick() {
  now_us_ += period_us_;
  wire_.set_time(now_us_);
  const double time_s = plant_.time_s();
  plant_bus_.set_time(time_s);
  controller_bus_.set_time(time_s);
  plant_.tick(now_us_ + period_us_, plant_bus_);
  controller_->step(now_us_, controller_port_);
}

bool BothEnds::set_faults(const std::vector<sim::FaultEvent>& faults) {
  if (!plant_.set_faults(faults)) return false;
  plant_bus_.set_events(faults);
  controller_bus_.set_events(faults);
  return true;
}

}  // namespace offnominal::desk::sil
