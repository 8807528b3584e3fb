// The controller's program told to end in every way that a shell has: it lets go of the arm first.
#include <gtest/gtest.h>

#include <array>
#include <csignal>
#include <nlohmann/json.hpp>

#include "desk/sil/controller_on_vcan.hpp"
#include "offnominal/hal/protocols/protected/address.hpp"
#include "sil/open_bus.hpp"

namespace offnominal::desk::sil {
namespace {

// Torque commands that say "off" among all that has come.
int off_commands(hal::SocketCan& listener) {
  int count = 0;
  std::array<hal::ReceivedFrame, 64> frames;
  for (std::size_t got = listener.receive(frames); got > 0; got = listener.receive(frames)) {
    for (std::size_t i = 0; i < got; ++i) {
      hal::Address address;
      if (address_of(frames[i].frame, address) != hal::Status::kOk) continue;
      if (address.kind != hal::MessageKind::kTorqueCommand) continue;
      hal::TorqueCommand command;
      std::uint8_t counter = 0;
      const auto id = data_id_of(address.kind, address.first_node);
      if (decode(record_in(frames[i].frame, 0), id, command, counter) != hal::Status::kOk) continue;
      count += command.mode == hal::DriveMode::kOff ? 1 : 0;
    }
  }
  return count;
}

class SignalledController : public testing::TestWithParam<int> {};

// GIVEN an arm under torque WHEN the signal comes THEN both drives are told "off" in five ticks,
// and the program ends by itself with its report.
TEST_P(SignalledController, DisarmsBeforeItEnds) {
  hal::SocketCan socket;
  open_bus("vcan0", {.may_restart_interface = false}, socket);
  hal::SocketCan listener;
  open_bus("vcan0", {.may_restart_interface = false}, listener);
  Arm<hal::SocketCan> arm(socket);
  ControllerProcess controller({});
  ASSERT_TRUE(arm.tick_until([&] { return arm.gives_torque() || controller.has_ended(); }));
  arm.ticks(20);
  ASSERT_TRUE(arm.gives_torque()) << controller.said();
  static_cast<void>(off_commands(listener));
  controller.signal(GetParam());
  ASSERT_TRUE(arm.tick_until([&] { return controller.has_ended(); }));
  const int status = controller.wait();
  ASSERT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_GE(off_commands(listener), 5 * 2);
  EXPECT_EQ(nlohmann::json::parse(controller.printed()).at("state"), "armed");
  EXPECT_FALSE(arm.gives_torque());
}

INSTANTIATE_TEST_SUITE_P(All, SignalledController,
                         testing::Values(SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGTSTP),
                         [](const auto& tested) {
                           return std::string(sigabbrev_np(tested.param));
                         });

}  // namespace
}  // namespace offnominal::desk::sil
