#pragma once

namespace offnominal::bench {

// How many of how many.
struct Rate {
  int hits = 0;
  int of = 0;

  void count(bool hit) {
    ++of;
    if (hit) ++hits;
  }
  void add(const Rate& other) {
    hits += other.hits;
    of += other.of;
  }
  [[nodiscard]] double percent() const { return of > 0 ? 100.0 * hits / of : 0; }
};

}  // namespace offnominal::bench
