#pragma once

#include <Eigen/Core>
#include <cstring>
#include <offnominal/repeat.hpp>
#include <utility>

// As many numbers at once as one vector of the processor holds, in the compiler's own vector types
// (GCC, Clang): +, -, *, / and comparisons are the language's, there is no function that a compiler
// may or may not inline. Loads and stores take any address, and every sum is formed in one order
// that the code alone decides: where an object lies changes no bit. Without vector instructions
// (Cortex-M) it is a plain number.

namespace offnominal {

// Hidden units are worked on in blocks of the processor's vector length; the capacity is rounded up
// to whole blocks (to nothing where there are no vector instructions).
template <typename Scalar>
inline constexpr int kLanes =
    Eigen::internal::packet_traits<Scalar>::size < 8 ? Eigen::internal::packet_traits<Scalar>::size
                                                     : 8;
template <int L, typename Scalar>
inline constexpr int kHiddenRows = (L + kLanes<Scalar> - 1) / kLanes<Scalar>* kLanes<Scalar>;

namespace detail {

template <typename Element, int Count>
struct VectorOf {
  using Type [[gnu::vector_size(Count * sizeof(Element))]] = Element;
};
template <typename Element>
struct VectorOf<Element, 1> {
  using Type = Element;
};

// So many hidden units at once.
template <typename Scalar>
using Block = typename VectorOf<Scalar, kLanes<Scalar>>::Type;

template <typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Block<Scalar> load(const Scalar* from) {
  if constexpr (kLanes<Scalar> == 1) {
    return *from;
  } else {
    Block<Scalar> block;
    std::memcpy(&block, from, sizeof block);
    return block;
  }
}
template <typename Scalar>
EIGEN_ALWAYS_INLINE void store(const Block<Scalar>& block, Scalar* to) {
  if constexpr (kLanes<Scalar> == 1) {
    *to = block;
  } else {
    std::memcpy(to, &block, sizeof block);
  }
}
template <typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Block<Scalar> spread(Scalar value) {
  // The plain sum with 0 would be a real one: it turns -0 into 0.
  return value - Block<Scalar>{};
}

// Count elements from `First` on.
template <int First, typename Half, typename Vector, int... I>
[[nodiscard]] EIGEN_ALWAYS_INLINE Half part(const Vector& vector,
                                            std::integer_sequence<int, I...> /*count*/) {
  return __builtin_shufflevector(vector, vector, (First + I)...);
}

// Sum of the elements: the upper half onto the lower one until one is left.
template <typename Scalar, int Count = kLanes<Scalar>>
[[nodiscard]] EIGEN_ALWAYS_INLINE Scalar
total(const typename VectorOf<Scalar, Count>::Type& block) {
  if constexpr (Count == 1) {
    return block;
  } else if constexpr (Count == 2) {
    return block[0] + block[1];
  } else {
    using Half = typename VectorOf<Scalar, Count / 2>::Type;
    constexpr auto kHalf = std::make_integer_sequence<int, Count / 2>{};
    return total<Scalar, Count / 2>(part<0, Half>(block, kHalf) +
                                    part<Count / 2, Half>(block, kHalf));
  }
}

// Rows in one turn of a loop where a block is one row: the more, the shorter what is done with a
// row; where it is so long that the loop's own instructions count for less than the room in flash,
// one.
inline constexpr int kShortRow = 8;
inline constexpr int kMediumRow = 5;
inline constexpr int kLongRow = 1;

// At most `most`, and a part of all rows without a rest where one is at least half of that: the
// rest would have to be written out beside the loop.
[[nodiscard]] constexpr int rows_in_turn(int rows, int most) {
  for (int turn = most; 2 * turn >= most; --turn) {
    if (turn > 0 && rows % turn == 0) return turn;
  }
  return most;
}

// body(row) for the first row of every block, in turns of about `Turn` rows where a block is one.
template <typename Scalar, int L, int Turn = kShortRow, typename Body>
EIGEN_ALWAYS_INLINE void for_each_block(const Body& body) {
  constexpr int kWidth = kLanes<Scalar>;
  constexpr int kRows = kHiddenRows<L, Scalar>;
  constexpr int kTurn = kWidth == 1 ? rows_in_turn(kRows, Turn) : kWidth;
  constexpr int kWhole = kRows / kTurn * kTurn;
  for (int row = 0; row < kWhole; row += kTurn) {
    repeat<kTurn / kWidth>([&](int i) __attribute__((always_inline)) { body(row + i * kWidth); });
  }
  repeat<(kRows - kWhole) / kWidth>([&](int i) __attribute__((always_inline)) {
    body(kWhole + i * kWidth);
  });
}

// Without vectors: body<Rows>(row) for the first row of every turn of kManyRows, and of what is
// left.
inline constexpr int kManyRows = 8;
template <int L, typename Body>
EIGEN_ALWAYS_INLINE void for_each_turn(const Body& body) {
  constexpr int kTurn = rows_in_turn(L, kManyRows);
  constexpr int kWhole = L / kTurn * kTurn;
  for (int row = 0; row < kWhole; row += kTurn) body.template operator()<kTurn>(row);
  if constexpr (kWhole < L) body.template operator()<L - kWhole>(kWhole);
}

}  // namespace detail
}  // namespace offnominal
