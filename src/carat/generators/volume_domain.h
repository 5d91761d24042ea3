#pragma once
// The unit cube and the unit ball: placing, drawing together and displacing the vertices of volume
// meshes.

#include <vector>

#include "carat/generators/families.h"
#include "carat/generators/volume_lattice.h"
#include "carat/mesh/polyhedral_mesh.h"

namespace carat {

/// Where the vertices of a family of volume meshes lie.
struct VolumeDomain {
  bool is_ball;
  double size;  ///< edge of a cube of its volume
  /// Image of a point of the unit cube, of its border on the border.
  Vec3 (*place)(const Vec3& x);
  /// Draws points of the domain together; 1: not at all.
  Vec3 (*squeeze)(const Vec3& x, double anisotropy);
  /// x moved by the offset or, on the border, by the part of it that lies within the border.
  Vec3 (*displace)(const Vec3& x, const Vec3& offset, bool on_border);
  /// Where graded families have their smallest cells, as a point of the unit cube.
  double finest_at;  ///< of all three coordinates
};

/// [0, 1]^3. squeeze() draws vertices together along x at x = 0, with slopes in that ratio.
extern const VolumeDomain kCube;

/// The unit ball about the origin. place() maps cubes about the middle to surfaces that go over
/// from cubes to spheres. Lengths along rays are multiplied by 0.65 to 1.35, angles are kept up to
/// a bounded factor, and both change smoothly but where two of the coordinates are equal in size:
/// there dihedral angles of cubes grow towards the border, where the edges of the cube are flat.
/// squeeze() maps the sphere as squeeze_sphere does.
extern const VolumeDomain kBall;

/// squeeze() of all points of the domain.
Points squeeze_points(const VolumeDomain& domain, const Points& points, double anisotropy);

/// place() and squeeze() of all points of the unit cube.
Points place_points(const VolumeDomain& domain, const Points& cube_points, double anisotropy);

/// The points of a lattice in the domain, then points well inside of its cubes.
Points place_lattice_and_centres(const VolumeDomain& domain, const CubeLattice& lattice,
                                 double anisotropy);

/// Moves every vertex to a random place within `jitter` times its shortest edge.
///
/// Every virtual tetrahedron keeps a tenth of its volume. Where one would not, the vertices of its
/// cell move half as far, and so on.
PolyhedralMesh jitter_cells(const PolyhedralMesh& mesh, const VolumeDomain& domain, double jitter,
                            std::uint64_t seed);

/// The points of the cells that have the least sum of squared virtual tetrahedra.
Points cell_points(const PolyhedralMesh& mesh);

/// Cells with a virtual tetrahedron that is not positive.
std::vector<Index> inverted_cells(const PolyhedralMesh& mesh);

/// The mesh of a family, jittered as the options say.
/// \throws InvalidOption  the anisotropy inverts cells
PolyhedralMesh finish_volume(const PolyhedralMesh& mesh, const VolumeDomain& domain,
                             const FamilyOptions& options);

}  // namespace carat
