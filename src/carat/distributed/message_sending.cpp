// Messages between processes by MPI.

#include <algorithm>

#include "carat/distributed/message.h"
#include "carat/distributed/petsc.h"

namespace carat {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 28;
constexpr int kTag = 1;

}  // namespace

void Message::send(int process) const {
  const std::uint64_t size = bytes_.size();
  MPI_Send(&size, 1, MPI_UINT64_T, process, kTag, PETSC_COMM_WORLD);
  for (std::size_t at = 0; at < bytes_.size(); at += kPiece)
    MPI_Send(bytes_.data() + at, static_cast<int>(std::min(kPiece, bytes_.size() - at)), MPI_BYTE,
             process, kTag, PETSC_COMM_WORLD);
}

Message Message::receive(int process) {
  std::uint64_t size = 0;
  MPI_Recv(&size, 1, MPI_UINT64_T, process, kTag, PETSC_COMM_WORLD, MPI_STATUS_IGNORE);
  Message message;
  message.bytes_.resize(static_cast<std::size_t>(size));
  for (std::size_t at = 0; at < message.bytes_.size(); at += kPiece)
    MPI_Recv(message.bytes_.data() + at,
             static_cast<int>(std::min(kPiece, message.bytes_.size() - at)), MPI_BYTE, process,
             kTag, PETSC_COMM_WORLD, MPI_STATUS_IGNORE);
  return message;
}

}  // namespace carat
