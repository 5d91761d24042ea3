#include "carat/distributed/exchange.h"

#include <algorithm>

#include "carat/base/error.h"
#include "carat/distributed/petsc.h"

namespace carat {
namespace {

void check_mpi(int error) {
  if (error != MPI_SUCCESS) throw SolverFailure("MPI failed: error " + std::to_string(error));
}

std::int64_t reduce(std::int64_t value, MPI_Op operation) {
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT64_T, operation, PETSC_COMM_WORLD));
  return value;
}

}  // namespace

int own_rank() {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return rank;
}

int n_processes() {
  int size = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  return size;
}

Lists<char> exchange_bytes(const std::vector<std::span<const char>>& to, std::size_t most) {
  const auto n = static_cast<std::size_t>(n_processes());
  std::vector<std::uint64_t> sending(n), receiving(n);
  for (std::size_t p = 0; p < n; ++p) sending[p] = to[p].size();
  check_mpi(MPI_Alltoall(sending.data(), 1, MPI_UINT64_T, receiving.data(), 1, MPI_UINT64_T,
                         PETSC_COMM_WORLD));
  Lists<char> from(n);
  for (std::size_t p = 0; p < n; ++p) from[p].resize(static_cast<std::size_t>(receiving[p]));
  // Every process sends every other at most this in a round.
  const std::size_t chunk = std::max<std::size_t>(most / n, 1);
  const auto largest = static_cast<std::int64_t>(*std::max_element(sending.begin(), sending.end()));
  const auto end = static_cast<std::size_t>(most_of_all(largest));
  std::vector<int> counts(n), starts(n), counts_in(n), starts_in(n);
  std::vector<char> out, in;
  for (std::size_t at = 0; at < end; at += chunk) {
    const auto plan = [&](const std::vector<std::uint64_t>& sizes, std::vector<int>& count,
                          std::vector<int>& start) {
      int total = 0;
      for (std::size_t p = 0; p < n; ++p) {
        const auto size = static_cast<std::size_t>(sizes[p]);
        count[p] = static_cast<int>(at < size ? std::min(chunk, size - at) : 0);
        start[p] = total;
        total += count[p];
      }
      return static_cast<std::size_t>(total);
    };
    out.resize(plan(sending, counts, starts));
    in.resize(plan(receiving, counts_in, starts_in));
    for (std::size_t p = 0; p < n; ++p)
      if (counts[p] > 0)
        std::memcpy(out.data() + starts[p], to[p].data() + at, static_cast<std::size_t>(counts[p]));
    check_mpi(MPI_Alltoallv(out.data(), counts.data(), starts.data(), MPI_BYTE, in.data(),
                            counts_in.data(), starts_in.data(), MPI_BYTE, PETSC_COMM_WORLD));
    for (std::size_t p = 0; p < n; ++p)
      if (counts_in[p] > 0)
        std::memcpy(from[p].data() + at, in.data() + starts_in[p],
                    static_cast<std::size_t>(counts_in[p]));
  }
  return from;
}

std::vector<Message> exchange(const std::vector<Message>& to) {
  std::vector<std::span<const char>> bytes;
  for (const Message& message : to) bytes.push_back(message.bytes());
  std::vector<Message> from;
  for (std::vector<char>& list : exchange_bytes(bytes)) from.emplace_back(std::move(list));
  return from;
}

std::vector<Message> all_of(const Message& own) {
  return exchange(std::vector<Message>(static_cast<std::size_t>(n_processes()), own));
}

std::vector<std::int64_t> sums_before(const std::vector<std::int64_t>& values,
                                      std::vector<std::int64_t>& totals) {
  const int n = static_cast<int>(values.size());
  std::vector<std::int64_t> before(values.size(), 0);
  totals.resize(values.size());
  check_mpi(MPI_Exscan(values.data(), before.data(), n, MPI_INT64_T, MPI_SUM, PETSC_COMM_WORLD));
  // The first process gets nothing.
  if (own_rank() == 0) std::fill(before.begin(), before.end(), 0);
  check_mpi(MPI_Allreduce(values.data(), totals.data(), n, MPI_INT64_T, MPI_SUM, PETSC_COMM_WORLD));
  return before;
}

std::int64_t sum_before(std::int64_t value, std::int64_t& total) {
  std::vector<std::int64_t> totals;
  const std::int64_t before = sums_before({value}, totals).front();
  total = totals.front();
  return before;
}

std::int64_t least_of_all(std::int64_t value) { return reduce(value, MPI_MIN); }
std::int64_t most_of_all(std::int64_t value) { return reduce(value, MPI_MAX); }

void check_count(std::int64_t n, const std::string& what) {
  constexpr std::int64_t kMost = std::numeric_limits<Index>::max();
  if (n > kMost)
    throw Shared<InvalidMesh>("the pieces have " + std::to_string(n) + " " + what +
                              "; this build numbers up to " + std::to_string(kMost) +
                              " (32 bit in carat's Index and in PETSc); use a coarser mesh, or "
                              "build with a wider Index and PETSc with 64-bit indices");
}

}  // namespace carat
