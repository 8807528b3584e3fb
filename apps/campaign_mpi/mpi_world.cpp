#include "campaign_mpi/mpi_world.hpp"

#include <mpi.h>

#include <cstdlib>

// MPI's own names are macros with casts as C has them.
// NOLINTBEGIN(cppcoreguidelines-pro-type-cstyle-cast)

namespace offnominal::desk {
namespace {

constexpr int kTag = 1;

MpiWorld::Message received(int rank) {
  MPI_Status status;
  MPI_Probe(rank, kTag, MPI_COMM_WORLD, &status);
  int count = 0;
  MPI_Get_count(&status, MPI_DOUBLE, &count);
  MpiWorld::Message message{status.MPI_SOURCE,
                            std::vector<double>(static_cast<std::size_t>(count))};
  MPI_Recv(message.numbers.data(), count, MPI_DOUBLE, message.from, kTag, MPI_COMM_WORLD,
           MPI_STATUS_IGNORE);
  return message;
}

}  // namespace

// Errors end all processes, which is MPI's default.
MpiWorld::MpiWorld(int& argc, char**& argv) { MPI_Init(&argc, &argv); }

MpiWorld::~MpiWorld() { MPI_Finalize(); }

int MpiWorld::rank() const {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

int MpiWorld::size() const {
  int size = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}

void MpiWorld::send(int to, const std::vector<double>& numbers) const {
  MPI_Send(numbers.data(), static_cast<int>(numbers.size()), MPI_DOUBLE, to, kTag, MPI_COMM_WORLD);
}

MpiWorld::Message MpiWorld::receive() const { return received(MPI_ANY_SOURCE); }

MpiWorld::Message MpiWorld::receive_from(int rank) const { return received(rank); }

std::string MpiWorld::from_first(const std::string& text) const {
  int size = static_cast<int>(text.size());
  MPI_Bcast(&size, 1, MPI_INT, 0, MPI_COMM_WORLD);
  std::string said = rank() == 0 ? text : std::string(static_cast<std::size_t>(size), ' ');
  MPI_Bcast(said.data(), size, MPI_CHAR, 0, MPI_COMM_WORLD);
  return said;
}

void MpiWorld::abort(int exit_code) const {
  MPI_Abort(MPI_COMM_WORLD, exit_code);
  std::abort();  // it does not come back
}

}  // namespace offnominal::desk

// NOLINTEND(cppcoreguidelines-pro-type-cstyle-cast)
