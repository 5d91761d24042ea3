#pragma once
// What operators share: checks of options and of degenerate samples.

#include <string>
#include <vector>

#include "carat/mesh/polyhedral_mesh.h"
#include "carat/operators/discretization.h"

namespace carat {

/// \throws InvalidOption  the operator has unknowns beyond the vertices
void require_vertex_unknowns(const Discretization& discretization, const std::string& application);

/// K at the centroid of a sample.
/// \throws InvalidOption  K is not a positive finite number there
double coefficient_at(const DiscretizationOptions& options, const Vec3& centroid);

/// \throws InvalidOption  cell_coefficient has another shape than it should, or a value that is not
///                        finite, or a cell's tensor is not positive definite
void check_cell_coefficient(const DiscretizationOptions& options, Index n_cells);

/// \throws InvalidOption  own_interfaces is neither empty nor one flag an interface
void check_own_interfaces(const DiscretizationOptions& options, Index n_interfaces);

/// K of a cell from the checked cell_coefficient; the identity where there is none.
Eigen::Matrix3d cell_tensor(const DiscretizationOptions& options, Index cell);

/// Lists degenerate samples, or throws under DegeneratePolicy::Strict.
/// \param kind      "diamond", "virtual triangle", "face"
/// \param describe  the first sample in words: its vertices and its measure
/// \throws DegenerateElement
void report_degenerate(std::vector<Index> samples, const DiscretizationOptions& options,
                       const std::string& kind, const std::function<std::string(Index)>& describe,
                       Diagnostics& diagnostics);

/// Lists the vertices without a face, or in volumes a cell: their rows and columns are empty.
void report_unreferenced(const PolygonMesh& mesh, Diagnostics& diagnostics);
void report_unreferenced(std::vector<Index> without_faces, Diagnostics& diagnostics);
void report_unreferenced(const PolyhedralMesh& mesh, Diagnostics& diagnostics);

/// Positions relative to the middle of their bounding box.
void centre_points(const Points& points, Points& centred, Vec3& origin);

/// Text of a number in an error message: shortest form that names the value.
std::string number(double value);

}  // namespace carat
