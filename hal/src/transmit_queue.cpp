#include "transmit_queue.hpp"

#include <algorithm>

namespace offnominal::hal {
namespace {

bool same_identifier(const Frame& one, const Frame& other) {
  return one.id == other.id && one.extended == other.extended;
}

}  // namespace

TransmitQueue::Placed TransmitQueue::place(const Frame& frame, Microseconds deadline_us) {
  Mailbox* room = nullptr;
  for (Mailbox& box : mailboxes_) {
    if (box.full && same_identifier(box.frame, frame)) {
      box = {true, frame, deadline_us};
      return Placed::kInPlaceOfOld;
    }
    if (!box.full && room == nullptr) room = &box;
  }
  if (room == nullptr) return Placed::kNoRoom;
  *room = {true, frame, deadline_us};
  ++waiting_;
  return Placed::kNew;
}

bool TransmitQueue::kernel_has(const Frame& frame) const {
  return std::any_of(
      kernel_.begin(), kernel_.begin() + static_cast<std::ptrdiff_t>(in_kernel_),
      [&](const InKernel& held) { return held.id == frame.id && held.extended == frame.extended; });
}

TransmitQueue::Mailbox* TransmitQueue::next() {
  if (waiting_ == 0 || in_kernel_ == window_) return nullptr;
  Mailbox* best = nullptr;
  for (Mailbox& box : mailboxes_) {
    if (!box.full || (best != nullptr && best->frame.id <= box.frame.id)) continue;
    if (!kernel_has(box.frame)) best = &box;
  }
  return best;
}

void TransmitQueue::taken(Mailbox& mailbox) {
  kernel_[in_kernel_] = {mailbox.frame.id, mailbox.frame.extended, false, mailbox.deadline_us};
  ++in_kernel_;
  mailbox.full = false;
  --waiting_;
}

bool TransmitQueue::gone_out(const Frame& frame, Microseconds time_us) {
  for (std::size_t i = 0; i < in_kernel_; ++i) {
    if (kernel_[i].id != frame.id || kernel_[i].extended != frame.extended) continue;
    const bool late = kernel_[i].late || time_us > kernel_[i].deadline_us;
    kernel_[i] = kernel_[--in_kernel_];
    return late;
  }
  return false;
}

std::uint32_t TransmitQueue::forget_late(Microseconds now_us) {
  std::uint32_t forgotten = 0;
  if (waiting_ == 0) return forgotten;
  for (Mailbox& box : mailboxes_) {
    if (!box.full || box.deadline_us >= now_us) continue;
    box.full = false;
    --waiting_;
    ++forgotten;
  }
  return forgotten;
}

std::uint32_t TransmitQueue::newly_late_in_kernel(Microseconds now_us) {
  std::uint32_t found = 0;
  for (std::size_t i = 0; i < in_kernel_; ++i) {
    if (kernel_[i].late || kernel_[i].deadline_us >= now_us) continue;
    kernel_[i].late = true;
    ++found;
  }
  return found;
}

std::uint32_t TransmitQueue::forget_waiting() {
  const auto forgotten = static_cast<std::uint32_t>(waiting_);
  for (Mailbox& box : mailboxes_) box.full = false;
  waiting_ = 0;
  return forgotten;
}

std::uint32_t TransmitQueue::forget_in_kernel() {
  const auto forgotten = static_cast<std::uint32_t>(
      std::count_if(kernel_.begin(), kernel_.begin() + static_cast<std::ptrdiff_t>(in_kernel_),
                    [](const InKernel& held) { return !held.late; }));
  in_kernel_ = 0;
  return forgotten;
}

}  // namespace offnominal::hal
