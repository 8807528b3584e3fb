#include <linux/can/error.h>
#include <net/if.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <new>
#include <offnominal/hal/bus/socketcan.hpp>

#include "interface_restart.hpp"
#include "raw_socket.hpp"
#include "receive_batch.hpp"
#include "transmit_queue.hpp"

namespace offnominal::hal {
namespace {

constexpr std::size_t kArrived = 256;  // frames that wait here for receive()
constexpr int kMostBatches = 8;        // a babbling node must not keep the caller
constexpr Microseconds kLookEvery = 10'000;

bool any_passes(std::span<const IdFilter> filters, const Frame& frame) {
  return std::any_of(filters.begin(), filters.end(),
                     [&](const IdFilter& filter) { return passes(filter, frame); });
}

// The error state that a controller reports, or the one before where the report is of another kind.
BusMode mode_after(const canfd_frame& report, BusMode before) {
  if ((report.can_id & CAN_ERR_RESTARTED) != 0) return BusMode::kActive;
  if ((report.can_id & CAN_ERR_CRTL) == 0 || before == BusMode::kOff) return before;
  const int controller = report.data[1];
  if ((controller & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
    return BusMode::kPassive;
  }
  if ((controller & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
    return BusMode::kWarning;
  }
  return (controller & CAN_ERR_CRTL_ACTIVE) != 0 ? BusMode::kActive : before;
}

}  // namespace

class SocketCan::Port {
 public:
  Port(const SocketCanConfig& config, int socket)
      : socket_(socket),
        pause_us_(config.pause_after_restart_us),
        transmit_all_(config.receive.empty()),
        receive_count_(config.receive.size()),
        transmit_count_(config.transmit.size()),
        queue_(config.in_kernel) {
    std::strncpy(interface_.data(), config.interface, IFNAMSIZ - 1);
    auto* end = std::copy(config.receive.begin(), config.receive.end(), filters_.begin());
    std::copy(config.transmit.begin(), config.transmit.end(), end);
    takes_fd_ = takes_can_fd(socket_.get(), interface_.data());
    if (is_interface_up(socket_.get(), interface_.data())) state_.mode = BusMode::kActive;
    can_take_back_ =
        config.may_restart_interface && restart_.start(socket_.get(), interface_.data());
  }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  Port(Port&&) = delete;
  Port& operator=(Port&&) = delete;
  ~Port() = default;

  Status send(const Frame& frame, Microseconds deadline_us);
  std::size_t receive(std::span<ReceivedFrame> into);
  void drop_pending();
  [[nodiscard]] const BusState& state() const { return state_; }
  [[nodiscard]] bool can_take_back() const { return can_take_back_; }
  [[nodiscard]] std::uint32_t sent_late() const { return sent_late_; }

 private:
  [[nodiscard]] bool is_out() const {
    return state_.mode == BusMode::kOff || state_.mode == BusMode::kDown;
  }
  [[nodiscard]] Status refusal() const {
    return state_.mode == BusMode::kOff ? Status::kBusOff : Status::kInterfaceDown;
  }
  [[nodiscard]] bool may_send(const Frame& frame) const {
    return is_well_formed(frame) && (takes_fd_ || !frame.fd) &&
           (transmit_all_ ||
            any_passes({filters_.data() + receive_count_, transmit_count_}, frame));
  }
  void hand_over(Microseconds now_us);
  void fetch();
  void accept(const RawArrival& arrival);
  void keep(const Frame& frame, Microseconds time_us);
  void heed(const canfd_frame& report);
  void forget_all();
  void go_down();
  void take_back(BusMode meanwhile, Microseconds pause_us);
  void come_back(Microseconds now_us);

  OwnedSocket socket_;  // ends last
  std::array<char, IFNAMSIZ> interface_{};
  Microseconds pause_us_;
  bool transmit_all_;
  std::size_t receive_count_;
  std::size_t transmit_count_;
  std::array<IdFilter, kMostFilters> filters_{};  // those of receive, then those of transmit
  bool takes_fd_ = false;
  bool can_take_back_ = false;
  TransmitQueue queue_;
  ReceiveBatch batch_;
  std::array<ReceivedFrame, kArrived> arrived_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::uint32_t overflow_ = 0;
  BusState state_{.mode = BusMode::kDown};
  std::uint32_t sent_late_ = 0;
  bool restarting_ = false;
  Microseconds pause_after_us_ = 0;
  Microseconds look_at_us_ = 0;
  InterfaceRestart restart_;
};

Status SocketCan::Port::send(const Frame& frame, Microseconds deadline_us) {
  if (!may_send(frame)) return Status::kFrameNotSupported;
  if (is_out()) return refusal();
  const Microseconds now_us = clock_us(CLOCK_MONOTONIC);
  if (deadline_us < now_us) {
    ++state_.late;
    return Status::kDeadlinePassed;
  }
  state_.late += queue_.forget_late(now_us);
  const TransmitQueue::Placed placed = queue_.place(frame, deadline_us);
  if (placed == TransmitQueue::Placed::kNoRoom) return Status::kQueueFull;
  if (placed == TransmitQueue::Placed::kInPlaceOfOld) ++state_.dropped;
  hand_over(now_us);
  if (queue_.waits() && !is_out()) {
    // The word that makes room may have come already.
    fetch();
    hand_over(now_us);
  }
  return is_out() ? refusal() : Status::kOk;
}

void SocketCan::Port::hand_over(Microseconds now_us) {
  if (is_out()) return;
  state_.late += queue_.forget_late(now_us);
  while (TransmitQueue::Mailbox* next = queue_.next()) {
    canfd_frame raw;
    const std::size_t size = to_kernel(next->frame, raw);
    if (::send(socket_.get(), &raw, size, MSG_DONTWAIT) == static_cast<ssize_t>(size)) {
      queue_.taken(*next);
      continue;
    }
    if (errno == ENETDOWN || errno == ENXIO || errno == ENODEV) go_down();
    return;  // otherwise the kernel has no room: the frame waits here
  }
}

std::size_t SocketCan::Port::receive(std::span<ReceivedFrame> into) {
  fetch();
  const Microseconds now_us = clock_us(CLOCK_MONOTONIC);
  if (is_out()) come_back(now_us);
  const std::uint32_t late = queue_.newly_late_in_kernel(now_us);
  state_.late += late;
  if (late > 0) take_back(BusMode::kDown, pause_us_);
  hand_over(now_us);

  const std::size_t handed = std::min(into.size(), count_);
  for (std::size_t i = 0; i < handed; ++i) into[i] = arrived_[(first_ + i) % kArrived];
  first_ = (first_ + handed) % kArrived;
  count_ -= handed;
  state_.received += static_cast<std::uint32_t>(handed);
  return handed;
}

void SocketCan::Port::fetch() {
  for (int batch = 0; batch < kMostBatches; ++batch) {
    int error = 0;
    const std::size_t got = batch_.fetch(socket_.get(), ReceiveBatch::kMost, error);
    for (std::size_t i = 0; i < got; ++i) accept(batch_.arrival(i));
    if (error != 0) go_down();
    if (got < ReceiveBatch::kMost) break;
  }
  state_.receive_overflow = overflow_ + batch_.lost();
}

void SocketCan::Port::accept(const RawArrival& arrival) {
  if ((arrival.raw->can_id & CAN_ERR_FLAG) != 0) {
    heed(*arrival.raw);
    return;
  }
  Frame frame;
  if (!from_kernel(*arrival.raw, arrival.size, frame)) return;
  if (arrival.own) {
    ++state_.sent;
    if (queue_.gone_out(frame, arrival.time_us)) ++sent_late_;
  } else if (receive_count_ == 0 || any_passes({filters_.data(), receive_count_}, frame)) {
    keep(frame, arrival.time_us);
  }
}

void SocketCan::Port::keep(const Frame& frame, Microseconds time_us) {
  if (count_ == kArrived) {
    first_ = (first_ + 1) % kArrived;
    --count_;
    ++overflow_;
  }
  arrived_[(first_ + count_) % kArrived] = {frame, time_us};
  ++count_;
}

void SocketCan::Port::heed(const canfd_frame& report) {
  ++state_.errors;
  if (state_.mode == BusMode::kDown || restarting_) return;
  if ((report.can_id & CAN_ERR_BUSOFF) == 0) {
    state_.mode = mode_after(report, state_.mode);
    return;
  }
  state_.mode = BusMode::kOff;
  // The kernel empties its queue only about a second after bus-off, and a restart may come before.
  take_back(BusMode::kOff, pause_us_);
  forget_all();
}

void SocketCan::Port::forget_all() {
  state_.dropped += queue_.forget_waiting() + queue_.forget_in_kernel();
}

void SocketCan::Port::go_down() {
  forget_all();
  if (state_.mode != BusMode::kOff || !restarting_) state_.mode = BusMode::kDown;
}

void SocketCan::Port::take_back(BusMode meanwhile, Microseconds pause_us) {
  if (!can_take_back_ || restarting_) return;
  forget_all();
  state_.mode = meanwhile;
  restarting_ = true;
  pause_after_us_ = pause_us;
  restart_.ask();
}

// From bus-off by the driver's report alone, where nothing was restarted here.
void SocketCan::Port::come_back(Microseconds now_us) {
  if (restarting_) {
    if (restart_.busy()) return;
    fetch();  // what the kernel said of the restart
    restarting_ = false;
    state_.mode = BusMode::kDown;
    look_at_us_ = now_us + pause_after_us_;
  }
  if (state_.mode != BusMode::kDown || now_us < look_at_us_) return;
  look_at_us_ = now_us + kLookEvery;
  if (is_interface_up(socket_.get(), interface_.data())) state_.mode = BusMode::kActive;
}

void SocketCan::Port::drop_pending() {
  state_.dropped += queue_.forget_waiting();
  fetch();
  if (queue_.kernel_has_any()) take_back(BusMode::kDown, 0);
}

SocketCan::SocketCan() = default;
SocketCan::~SocketCan() = default;

Status SocketCan::open(const SocketCanConfig& config) {
  port_.reset();
  int socket = -1;
  const Status status = open_raw_socket(config, socket);
  error_number_ = status == Status::kOk ? 0 : errno;
  if (status != Status::kOk) return status;
  port_.reset(new (std::nothrow) Port(config, socket));
  if (port_ != nullptr) return Status::kOk;
  ::close(socket);
  error_number_ = ENOMEM;
  return Status::kSystemError;
}

Microseconds SocketCan::now() const { return clock_us(CLOCK_MONOTONIC); }

Status SocketCan::send(const Frame& frame, Microseconds deadline_us) {
  if (port_ != nullptr) return port_->send(frame, deadline_us);
  return is_well_formed(frame) ? Status::kInterfaceDown : Status::kFrameNotSupported;
}

std::size_t SocketCan::receive(std::span<ReceivedFrame> into) {
  return port_ != nullptr ? port_->receive(into) : 0;
}

void SocketCan::drop_pending() {
  if (port_ != nullptr) port_->drop_pending();
}

BusState SocketCan::state() const {
  return port_ != nullptr ? port_->state() : BusState{.mode = BusMode::kDown};
}

bool SocketCan::can_take_back() const { return port_ != nullptr && port_->can_take_back(); }

std::uint32_t SocketCan::sent_late() const { return port_ != nullptr ? port_->sent_late() : 0; }

}  // namespace offnominal::hal
