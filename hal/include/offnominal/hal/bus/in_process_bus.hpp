#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/hal/bus/bus.hpp>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/hal/status.hpp>
#include <span>

namespace offnominal::hal {

// A bus inside one program, for unit tests and for runs that have to repeat exactly: what one port
// sends, every other port finds at its next receive(), in the order of sending. Time stands still
// until it is moved by hand. Not for several threads. Ports: how many take part; Depth: frames that
// wait at a port, the oldest is lost for one more.
template <std::size_t Ports, std::size_t Depth = 256>
class InProcessNet {
 public:
  static constexpr std::size_t kMailboxes = 64;

  [[nodiscard]] Microseconds now() const { return now_us_; }
  // Time never goes back: an earlier one is not taken.
  void set_time(Microseconds now_us) { now_us_ = std::max(now_us_, now_us); }

  // Blocked, as by a node that sends without a pause on a stronger identifier: frames wait. Freed,
  // those go out, the lowest identifier first, that their deadlines still allow.
  void set_blocked(bool blocked) {
    blocked_ = blocked;
    if (blocked) return;
    for (;;) {
      std::size_t sender = Ports;
      Mailbox* next = nullptr;
      for (std::size_t p = 0; p < Ports; ++p) {
        drop_late(p);
        for (Mailbox& box : nodes_[p].mailboxes) {
          if (!box.full || (next != nullptr && next->frame.id <= box.frame.id)) continue;
          next = &box;
          sender = p;
        }
      }
      if (next == nullptr) return;
      next->full = false;
      deliver(sender, next->frame);
    }
  }

  // Bus-off of one node: it neither sends nor receives, what waits is dropped.
  void set_mode(std::size_t port, BusMode mode) {
    nodes_[port].state.mode = mode;
    if (is_out(mode)) drop_pending(port);
  }

  // One node's view, a Bus. The net has to outlive it.
  class Port {
   public:
    Port(InProcessNet& net, std::size_t index) : net_(&net), index_(index) {}
    [[nodiscard]] Microseconds now() { return net_->now(); }
    [[nodiscard]] Status send(const Frame& frame, Microseconds deadline_us) {
      return net_->send(index_, frame, deadline_us);
    }
    [[nodiscard]] std::size_t receive(std::span<ReceivedFrame> into) {
      return net_->receive(index_, into);
    }
    void drop_pending() { net_->drop_pending(index_); }
    [[nodiscard]] BusState state() const { return net_->nodes_[index_].state; }

   private:
    InProcessNet* net_;
    std::size_t index_;
  };
  // `index` below Ports.
  [[nodiscard]] Port port(std::size_t index) { return Port(*this, index); }

 private:
  struct Mailbox {
    bool full = false;
    Frame frame;
    Microseconds deadline_us = 0;
  };
  struct Node {
    BusState state;
    std::array<Mailbox, kMailboxes> mailboxes{};
    std::array<ReceivedFrame, Depth> arrived{};
    std::size_t first = 0;
    std::size_t count = 0;
  };

  static bool is_out(BusMode mode) { return mode == BusMode::kOff || mode == BusMode::kDown; }

  Status send(std::size_t port, const Frame& frame, Microseconds deadline_us) {
    Node& node = nodes_[port];
    if (!is_well_formed(frame)) return Status::kFrameNotSupported;
    if (node.state.mode == BusMode::kOff) return Status::kBusOff;
    if (node.state.mode == BusMode::kDown) return Status::kInterfaceDown;
    if (deadline_us < now_us_) {
      ++node.state.late;
      return Status::kDeadlinePassed;
    }
    if (!blocked_) {
      deliver(port, frame);
      return Status::kOk;
    }
    drop_late(port);
    const auto same = [&](const Mailbox& box) { return box.full && box.frame.id == frame.id; };
    const auto empty = [](const Mailbox& box) { return !box.full; };
    auto box = std::find_if(node.mailboxes.begin(), node.mailboxes.end(), same);
    if (box != node.mailboxes.end()) {
      ++node.state.dropped;
    } else {
      box = std::find_if(node.mailboxes.begin(), node.mailboxes.end(), empty);
    }
    if (box == node.mailboxes.end()) return Status::kQueueFull;
    *box = {true, frame, deadline_us};
    return Status::kOk;
  }

  std::size_t receive(std::size_t port, std::span<ReceivedFrame> into) {
    drop_late(port);
    Node& node = nodes_[port];
    const std::size_t fetched = std::min(into.size(), node.count);
    for (std::size_t i = 0; i < fetched; ++i) into[i] = node.arrived[(node.first + i) % Depth];
    node.first = (node.first + fetched) % Depth;
    node.count -= fetched;
    node.state.received += static_cast<std::uint32_t>(fetched);
    return fetched;
  }

  void drop_pending(std::size_t port) {
    Node& node = nodes_[port];
    for (Mailbox& box : node.mailboxes) {
      if (box.full) ++node.state.dropped;
      box.full = false;
    }
  }

  void drop_late(std::size_t port) {
    Node& node = nodes_[port];
    for (Mailbox& box : node.mailboxes) {
      if (!box.full || box.deadline_us >= now_us_) continue;
      box.full = false;
      ++node.state.late;
    }
  }

  void deliver(std::size_t sender, const Frame& frame) {
    ++nodes_[sender].state.sent;
    for (std::size_t p = 0; p < Ports; ++p) {
      Node& node = nodes_[p];
      if (p == sender || is_out(node.state.mode)) continue;
      if (node.count == Depth) {
        node.first = (node.first + 1) % Depth;
        --node.count;
        ++node.state.receive_overflow;
      }
      node.arrived[(node.first + node.count) % Depth] = {frame, now_us_};
      ++node.count;
    }
  }

  Microseconds now_us_ = 0;
  bool blocked_ = false;
  std::array<Node, Ports> nodes_{};
};

static_assert(Bus<InProcessNet<2>::Port>);

}  // namespace offnominal::hal
