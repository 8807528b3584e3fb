#pragma once

#include <offnominal/hal/status.hpp>
#include <string>

namespace offnominal::hal {

// A virtual CAN interface of the Linux kernel that is made where there is none, and goes with its
// maker.
class VirtualCan {
 public:
  VirtualCan() = default;
  VirtualCan(const VirtualCan&) = delete;
  VirtualCan& operator=(const VirtualCan&) = delete;
  VirtualCan(VirtualCan&&) = delete;
  VirtualCan& operator=(VirtualCan&&) = delete;
  // Removes what make() has made.
  ~VirtualCan();

  // An interface that is there is left as it is: kOk, and was_made() is false. Otherwise one is
  // made, for CAN and CAN FD, and brought up. kNotPermitted: that takes CAP_NET_ADMIN.
  // kNoSuchInterface: this kernel has no virtual CAN. kSystemError: error_number() is the kernel's
  // errno. Uses the heap.
  [[nodiscard]] Status make(const std::string& interface);
  [[nodiscard]] bool was_made() const { return !made_.empty(); }
  [[nodiscard]] int error_number() const { return error_number_; }

 private:
  std::string made_;
  int error_number_ = 0;
};

}  // namespace offnominal::hal
