#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

// How many joints: on a controller a number that the compiler knows, on the desk one that a robot
// file says. The same templates serve both. kRuntimeJoints in place of the number makes every size
// one of run time, with room for kMaxJoints inside the object: no heap, and to the last bit what
// the number itself computes.

namespace offnominal {

// The most joints where their number is known at run time only. (A template takes as many as its
// compiler does.)
inline constexpr int kMaxJoints = 12;

// Eigen::Dynamic, and as a std::size_t std::dynamic_extent.
inline constexpr int kRuntimeJoints = -1;

template <int N>
inline constexpr int kMostJoints = N == kRuntimeJoints ? kMaxJoints : N;

// Up to Most numbers or structs, inside the object.
template <typename T, std::size_t Most>
class BoundedArray {
 public:
  // `size` at most Most.
  constexpr void assign(std::size_t size, const T& value) {
    size_ = static_cast<std::uint8_t>(size);
    fill(value);
  }
  constexpr void fill(const T& value) {
    for (T& item : *this) item = value;
  }
  [[nodiscard]] constexpr std::size_t size() const { return size_; }
  [[nodiscard]] constexpr bool empty() const { return size_ == 0; }
  [[nodiscard]] constexpr T& operator[](std::size_t i) { return items_[i]; }
  [[nodiscard]] constexpr const T& operator[](std::size_t i) const { return items_[i]; }
  [[nodiscard]] constexpr T* data() { return items_.data(); }
  [[nodiscard]] constexpr const T* data() const { return items_.data(); }
  [[nodiscard]] constexpr T* begin() { return items_.data(); }
  [[nodiscard]] constexpr T* end() { return items_.data() + size_; }
  [[nodiscard]] constexpr const T* begin() const { return items_.data(); }
  [[nodiscard]] constexpr const T* end() const { return items_.data() + size_; }

 private:
  static_assert(Most <= 255, "size counts in 8 bits");
  std::array<T, Most> items_{};
  std::uint8_t size_ = 0;
};

namespace detail {

template <int Size, int Most, typename T>
struct ArrayOf {
  using Type = std::array<T, static_cast<std::size_t>(Size)>;
};
template <int Most, typename T>
struct ArrayOf<kRuntimeJoints, Most, T> {
  using Type = BoundedArray<T, static_cast<std::size_t>(Most)>;
};

}  // namespace detail

// One T per joint; empty at first where the number of joints is one of run time.
template <int N, typename T>
using PerJoint = typename detail::ArrayOf<N, kMaxJoints, T>::Type;
// One T per pair of joints.
template <int N, typename T>
using PerJointPair = typename detail::ArrayOf<N == kRuntimeJoints ? kRuntimeJoints : N * N,
                                              kMaxJoints * kMaxJoints, T>::Type;

}  // namespace offnominal
