#pragma once
// Random displacement of vertices that never folds a face.

#include "carat/generators/families.h"
#include "carat/mesh/polygon_mesh.h"

namespace carat {

/// The surface that the vertices of a family stay on.
struct Domain {
  /// Measure of triangle a, b, c, positive if counter-clockwise seen from outside.
  double (*turn)(const Vec3& a, const Vec3& b, const Vec3& c);
  /// x moved within the surface by about |offset|; border points stay on their side.
  Vec3 (*displace)(const Vec3& x, const Vec2& offset);
};

extern const Domain kSquare;  ///< [0, 1]^2 x {0}
extern const Domain kSphere;  ///< of radius 1
extern const Domain kTorus;   ///< about z, radii 1 and kTubeRadius

inline constexpr double kTubeRadius = 0.4;

/// Moves every vertex to a random place within options.jitter times its shortest edge.
///
/// With a tenth of its former measure as the limit, every corner of a face stays convex or, where
/// `kernel_points` are given (one a face), every triangle from a side to that point stays positive.
/// Where a face would pass the limit its vertices move half as far, and so on.
/// \return the mesh itself if options.jitter is 0
PolygonMesh jitter_vertices(const PolygonMesh& mesh, const Domain& domain,
                            const FamilyOptions& options, const Points* kernel_points = nullptr);

}  // namespace carat
