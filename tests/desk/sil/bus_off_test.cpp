// The controller's program where its node goes bus-off: the arm under torque, the frames
// afterwards, the way back.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ctime>
#include <nlohmann/json.hpp>

#include "desk/sil/controller_on_vcan.hpp"
#include "support/raw_can.hpp"

namespace offnominal::desk::sil {
namespace {

using testing::HasSubstr;

// The arm's node: one that bus-off does not concern. The kernel tells every socket on the interface
// of it, as if it were each one's own.
class HealthyNode {
 public:
  [[nodiscard]] hal::Microseconds now() const {
    timespec time{};
    ::clock_gettime(CLOCK_MONOTONIC, &time);
    return time.tv_sec * 1'000'000 + time.tv_nsec / 1000;
  }
  [[nodiscard]] hal::Status send(const hal::Frame& frame, hal::Microseconds /*deadline_us*/) {
    test::RawFrame raw;
    raw.frame.can_id = frame.id;
    raw.frame.len = frame.length;
    std::memcpy(raw.frame.data, frame.data.data(), frame.length);
    return node_.send(raw) ? hal::Status::kOk : hal::Status::kQueueFull;
  }
  [[nodiscard]] std::size_t receive(std::span<hal::ReceivedFrame> into) {
    std::size_t count = 0;
    while (count < into.size()) {
      const auto raw = node_.receive(std::chrono::milliseconds{0});
      if (!raw) break;
      if ((raw->frame.can_id & CAN_ERR_FLAG) != 0) continue;
      hal::ReceivedFrame& frame = into[count++];
      frame = {};
      frame.frame.id = raw->frame.can_id;
      frame.frame.length = raw->frame.len;
      std::memcpy(frame.frame.data.data(), raw->frame.data, raw->frame.len);
      frame.time_us = now();
    }
    return count;
  }
  void drop_pending() {}
  [[nodiscard]] hal::BusState state() const { return {}; }

 private:
  test::RawCan node_{"vcan0"};
};
static_assert(hal::Bus<HealthyNode>);

// GIVEN an arm under torque WHEN the controller's node goes bus-off THEN every drive has let go
// within the watch-dogs' five periods, nothing that was waiting commands one after the restart, and
// torque comes back only after the fault has been cleared and the controller armed again.
TEST(BusOff, EndsTheTorqueUntilSomebodyClearsTheFaultAndArms) {
  HealthyNode node;
  const test::RawCan driver("vcan0");
  Arm<HealthyNode> arm(node);
  ControllerProcess controller({"--no-restart"});
  ASSERT_TRUE(arm.tick_until([&] { return arm.gives_torque() || controller.has_ended(); }));
  arm.ticks(200);
  ASSERT_TRUE(arm.gives_torque()) << controller.said();

  ASSERT_TRUE(
      driver.send(test::raw_frame(CAN_ERR_FLAG | CAN_ERR_BUSOFF, {0, 0, 0, 0, 0, 0, 0, 0})));
  arm.ticks(8);
  EXPECT_FALSE(arm.gives_torque());
  arm.ticks(1000);

  ASSERT_TRUE(
      driver.send(test::raw_frame(CAN_ERR_FLAG | CAN_ERR_RESTARTED, {0, 0, 0, 0, 0, 0, 0, 0})));
  for (int tick = 0; tick < 1000; ++tick) {
    arm.tick();
    ASSERT_FALSE(arm.gives_torque()) << tick << " ticks after the restart";
  }
  EXPECT_THAT(controller.said(), HasSubstr("fault: BusLost"));

  arm.put_back();  // it has fallen
  controller.signal(SIGUSR1);
  arm.ticks(200);
  EXPECT_FALSE(arm.gives_torque()) << "armed out of a fault";
  controller.signal(SIGUSR2);
  arm.ticks(500);
  EXPECT_FALSE(arm.gives_torque()) << "cleared, not armed";
  controller.signal(SIGUSR1);
  arm.ticks(500);
  EXPECT_TRUE(arm.gives_torque()) << controller.said();
  controller.signal(SIGTERM);
  ASSERT_TRUE(arm.tick_until([&] { return controller.has_ended(); }));
  EXPECT_FALSE(arm.gives_torque());
  const int status = controller.wait();
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  const auto outcome = nlohmann::json::parse(controller.printed());
  EXPECT_EQ(outcome.at("state"), "armed") << outcome.dump(1);
  EXPECT_EQ(outcome.at("fault"), "BusLost");
}

}  // namespace
}  // namespace offnominal::desk::sil
