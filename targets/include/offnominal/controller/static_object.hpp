#pragma once

#include <cstddef>
#include <new>
#include <utility>

namespace offnominal::controller {

// Room for one object that lives as long as the firmware, in RAM that the linker accounts for. It
// is made when make() says so, not before main() in an order that nobody sees, and never destroyed.
template <typename T>
class StaticObject {
 public:
  // Again makes it anew, without having destroyed the one before.
  template <typename... Arguments>
  T& make(Arguments&&... arguments) {
    return *new (storage_) T(std::forward<Arguments>(arguments)...);
  }
  // After make().
  [[nodiscard]] T& operator*() { return *std::launder(reinterpret_cast<T*>(storage_)); }
  [[nodiscard]] T* operator->() { return &**this; }

 private:
  alignas(T) std::byte storage_[sizeof(T)]{};  // zeros: constinit, and no part of the image
};

}  // namespace offnominal::controller
