#pragma once

#include <string>
#include <vector>

// MPI (the Message Passing Interface standard, 3.1) as far as handing out runs needs it.

namespace offnominal::desk {

/// All processes of an `mpirun`. One object for a process's life, on its main thread.
class MpiWorld {
 public:
  MpiWorld(int& argc, char**& argv);
  ~MpiWorld();
  MpiWorld(const MpiWorld&) = delete;
  MpiWorld& operator=(const MpiWorld&) = delete;

  [[nodiscard]] int rank() const;  // from 0
  [[nodiscard]] int size() const;

  struct Message {
    int from = 0;
    std::vector<double> numbers;
  };
  void send(int to, const std::vector<double>& numbers) const;
  /// The next message of anybody, or of one rank.
  [[nodiscard]] Message receive() const;
  [[nodiscard]] Message receive_from(int rank) const;
  /// What rank 0 says, on every rank.
  [[nodiscard]] std::string from_first(const std::string& text) const;
  /// Ends all processes.
  [[noreturn]] void abort(int exit_code) const;
};

}  // namespace offnominal::desk
