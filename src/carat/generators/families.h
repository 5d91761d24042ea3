#pragma once
// Families of test meshes with known geometry, refinable to any level.

#include <cstdint>
#include <string>
#include <vector>

#include "carat/mesh/polygon_mesh.h"

namespace carat {

/// What every family understands.
struct FamilyOptions {
  int level = 0;             ///< each level halves the edge length
  double jitter = 0;         ///< random displacement of inner vertices, 0 .. 0.5 of the shortest
                             ///< edge at each vertex; boundaries and spheres are kept exactly
  double anisotropy = 1;     ///< >= 1: vertices drawn together along x (see each family)
  std::uint64_t seed = 1;    ///< of the jitter and of random sites
};

/// A mesh family: `name` as on the command line.
struct FamilyEntry {
  const char* name;
  const char* title;   ///< one line
  const char* domain;  ///< "unit square", "unit sphere", "torus"
  PolygonMesh (*generate)(const FamilyOptions&);
};

/// All families, in the order of families.def.
const std::vector<FamilyEntry>& mesh_families();

/// \throws InvalidOption  unknown family (the message lists the known ones), level < 0 or too
///                        deep for 32-bit indices, jitter outside [0, 0.5], anisotropy < 1
PolygonMesh generate_mesh(const std::string& family, const FamilyOptions& options = {});

}  // namespace carat
