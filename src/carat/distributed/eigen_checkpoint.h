#pragma once
// Eigenpairs in a file, from which a run that ended early goes on. Seen by this folder's sources
// alone.

#include <filesystem>
#include <vector>

#include "carat/distributed/part_exchange.h"

namespace carat {

struct DistributedPair {
  double value;
  PetscVector vector;
};

/// Collective. Every process writes its own rows; the file is replaced when all have. Binary, in
/// the byte order of the machine: "carateig", the numbers of vertices and pairs (64 bits), the
/// values, the vertices by rows (32 bits), the vectors by rows one after the other.
/// \throws IoError  Shared
void save_pairs(const std::filesystem::path& path, const PartNumbers& numbers,
                const std::vector<DistributedPair>& pairs);

/// Collective. The pairs of a file that any number of processes has written; none if there is no
/// file.
/// \throws IoError  Shared; also a file of another number of vertices
std::vector<DistributedPair> load_pairs(const std::filesystem::path& path,
                                        const PartNumbers& numbers, const PartExchange& exchange);

}  // namespace carat
