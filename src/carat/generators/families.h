#pragma once
// Families of test meshes with known geometry, refinable to any level.

#include <cstdint>
#include <string>
#include <vector>

#include "carat/mesh/polygon_mesh.h"
#include "carat/mesh/polyhedral_mesh.h"

namespace carat {

/// What every family understands.
struct FamilyOptions {
  int level = 0;      ///< each level halves the edge length
  double jitter = 0;  ///< random displacement of vertices (Voronoi cells: of the sites), 0 .. 0.5
                      ///< of the shortest edge at each, less where a face would fold or a virtual
                      ///< tetrahedron lose 9/10; border vertices stay on their side, others on
                      ///< their surface
  double anisotropy = 1;   ///< 1 .. 1000: vertices drawn together; plane and cube: towards x = 0
                           ///< with slopes in this ratio; sphere and ball: along z; torus: towards
                           ///< the +x side
  std::uint64_t seed = 1;  ///< of the jitter, and of random sites and hexahedra
};

/// A mesh family: `name` as on the command line.
template <class Mesh>
struct FamilyEntryOf {
  const char* name;
  const char* title;   ///< one line
  const char* domain;  ///< "unit square", "unit sphere", "torus"; "unit cube", "unit ball"
  Mesh (*generate)(const FamilyOptions&);
};
using FamilyEntry = FamilyEntryOf<PolygonMesh>;
using VolumeFamilyEntry = FamilyEntryOf<PolyhedralMesh>;

/// All families, in the order of families.def and volume_families.def.
const std::vector<FamilyEntry>& mesh_families();
const std::vector<VolumeFamilyEntry>& volume_families();

/// \throws InvalidOption  unknown family (the message lists the known ones), level < 0 or too
///                        deep for 32-bit indices, jitter outside [0, 0.5], anisotropy
///                        outside [1, 1000], or in a ball so large that it inverts cells
PolygonMesh generate_mesh(const std::string& family, const FamilyOptions& options = {});
PolyhedralMesh generate_volume(const std::string& family, const FamilyOptions& options = {});

}  // namespace carat
