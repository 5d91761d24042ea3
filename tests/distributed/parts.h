#pragma once
// Parts of meshes that every process makes for itself.

#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>

#include "carat/apps/boundary_conditions.h"
#include "carat/distributed/processes.h"
#include "carat/operators/registry.h"
#include "support/mesh_parts.h"

namespace carat::test {

inline int rank() {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}
inline int n_processes() {
  int size = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}

template <class Mesh>
MeshPart<Mesh> own_part(const Mesh& mesh, const std::vector<Index>& element_part) {
  return part_of(mesh, divide(mesh, n_processes(), element_part), rank());
}

template <class Mesh>
MeshPart<Mesh> own_block(const Mesh& mesh) {
  return own_part(mesh, in_blocks(n_elements(mesh), n_processes()));
}

inline Vector select(const Vector& whole, const PartNumbers& numbers) {
  Vector own(static_cast<Index>(numbers.vertices.size()));
  for (Index v = 0; v < own.size(); ++v) own[v] = whole[numbers.vertices[v]];
  return own;
}

/// The conditions on what the part holds, in its numbers.
inline BoundaryConditions select(const BoundaryConditions& whole, const PartNumbers& numbers) {
  BoundaryConditions own;
  const auto find = [](const auto& list, Index number) {
    const auto at = std::lower_bound(list.begin(), list.end(), number);
    return at != list.end() && *at == number ? static_cast<Index>(at - list.begin()) : -1;
  };
  for (std::size_t k = 0; k < whole.dirichlet_vertices.size(); ++k)
    if (const Index v = find(numbers.vertices, whole.dirichlet_vertices[k]); v >= 0) {
      own.dirichlet_vertices.push_back(v);
      own.dirichlet_values.push_back(whole.dirichlet_values[k]);
    }
  for (std::size_t k = 0; k < whole.neumann_sides.size(); ++k)
    if (const Index side = find(numbers.interfaces, whole.neumann_sides[k]); side >= 0) {
      own.neumann_sides.push_back(side);
      own.neumann_flux.push_back(whole.neumann_flux[k]);
    }
  for (std::size_t k = 0; k < whole.robin_sides.size(); ++k)
    if (const Index side = find(numbers.interfaces, whole.robin_sides[k]); side >= 0) {
      own.robin_sides.push_back(side);
      own.robin_alpha.push_back(whole.robin_alpha[k]);
      own.robin_g.push_back(whole.robin_g[k]);
    }
  return own;
}

/// Largest difference beside the largest value of the whole.
inline double difference(const Vector& own, const Vector& whole, const PartNumbers& numbers) {
  const Vector expected = select(whole, numbers);
  if (own.size() != expected.size()) return HUGE_VAL;
  if (own.size() == 0) return 0;
  return (own - expected).lpNorm<Eigen::Infinity>() / whole.lpNorm<Eigen::Infinity>();
}

}  // namespace carat::test
