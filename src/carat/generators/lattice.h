#pragma once
// What the mesh families share: sizes, grading, grids, numbering.

#include "carat/generators/families.h"
#include "carat/mesh/polygon_mesh.h"

namespace carat {

/// Cells along a side at a level, base * 2^level.
/// \param corners_per_square  corners of the mesh over the square of the result
/// \throws InvalidOption  the mesh would have 2^31 corners or more
Index lattice_size(int level, Index base, double corners_per_square);

/// Maps [0, 1] onto itself, increasing, 0 and 1 exactly fixed. Its slope grows from one end to the
/// other by the factor `anisotropy`, so that vertices are drawn together along x at x = 0.
double grade(double t, double anisotropy);

/// The unit square in n by n rectangles, graded along x. Vertices and faces row by row.
PolygonMesh square_quads(Index n, double anisotropy);

/// The same mesh with the vertices numbered as the faces first meet them.
PolygonMesh number_by_first_use(const Points& points, Csr faces);

/// The image of points of the unit sphere under (x, y, z / anisotropy), scaled back to length 1.
/// It draws vertices together along z, at the equator, and maps great circles to great circles,
/// so that convex faces stay convex and star-shaped ones star-shaped.
Points squeeze_sphere(const Points& points, double anisotropy);

}  // namespace carat
