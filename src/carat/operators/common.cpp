#include "carat/operators/common.h"

#include <Eigen/LU>
#include <cmath>
#include <cstdio>

#include "carat/base/error.h"

namespace carat {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

void require_vertex_unknowns(const Discretization& discretization, const std::string& application) {
  if (discretization.extra.size() > 0)
    throw InvalidOption(application + ": the operator " + discretization.name + " has " +
                        std::to_string(discretization.extra.size()) +
                        " unknowns beyond the vertices; choose an operator between vertices, e.g. "
                        "diamond");
}

double coefficient_at(const DiscretizationOptions& options, const Vec3& centroid) {
  const double k = options.coefficient(centroid);
  if (!(std::isfinite(k) && k > 0))
    throw InvalidOption("the coefficient is " + number(k) + " at (" + number(centroid.x()) + ", " +
                        number(centroid.y()) + ", " + number(centroid.z()) +
                        "); it must be a positive finite number everywhere on the mesh");
  return k;
}

void check_cell_coefficient(const DiscretizationOptions& options, Index n_cells) {
  const Matrix& k = options.cell_coefficient;
  if (k.size() == 0) return;
  if (k.rows() != n_cells || (k.cols() != 1 && k.cols() != 6))
    throw InvalidOption("cell_coefficient is a " + std::to_string(k.rows()) + " x " +
                        std::to_string(k.cols()) + " array for " + std::to_string(n_cells) +
                        " cells; it must have one row a cell, of 1 value or of 6 (xx yy zz xy yz "
                        "xz)");
  for (Index c = 0; c < n_cells; ++c) {
    const Eigen::Matrix3d tensor = cell_tensor(options, c);
    // Positive definite: all leading minors are.
    const bool sound = tensor.allFinite() && tensor(0, 0) > 0 &&
                       tensor.topLeftCorner<2, 2>().determinant() > 0 && tensor.determinant() > 0;
    if (sound) continue;
    std::string values;
    for (Index i = 0; i < k.cols(); ++i) values.append(1, ' ').append(number(k(c, i)));
    const char* const wanted =
        k.cols() == 1 ? "a positive finite number" : "a symmetric positive definite tensor";
    throw InvalidOption("the coefficient of cell " + std::to_string(c) + " is" + values +
                            "; it must be " + wanted + " in every cell",
                        {c});
  }
}

void check_own_interfaces(const DiscretizationOptions& options, Index n_interfaces) {
  const std::size_t n = options.own_interfaces.size();
  if (n != 0 && n != static_cast<std::size_t>(n_interfaces))
    throw InvalidOption("own_interfaces has " + std::to_string(n) + " flags for " +
                        std::to_string(n_interfaces) + " edges or faces");
}

Eigen::Matrix3d cell_tensor(const DiscretizationOptions& options, Index cell) {
  const Matrix& k = options.cell_coefficient;
  if (k.size() == 0) return Eigen::Matrix3d::Identity();
  if (k.cols() == 1) return k(cell, 0) * Eigen::Matrix3d::Identity();
  Eigen::Matrix3d tensor;
  tensor << k(cell, 0), k(cell, 3), k(cell, 5), k(cell, 3), k(cell, 1), k(cell, 4), k(cell, 5),
      k(cell, 4), k(cell, 2);
  return tensor;
}

void report_degenerate(std::vector<Index> samples, const DiscretizationOptions& options,
                       const std::string& kind, const std::function<std::string(Index)>& describe,
                       Diagnostics& diagnostics) {
  if (options.degenerate == DegeneratePolicy::Strict && !samples.empty()) {
    const std::string message =
        kind + " " + std::to_string(samples[0]) + " (" + describe(samples[0]) +
        ") is degenerate: its measure is below " + number(options.eps_rel) +
        " of its diameter to the power of its dimension, as for " +
        std::to_string(samples.size() - 1) +
        " more; repair the mesh, or use DegeneratePolicy::Report to leave them out";
    throw DegenerateElement(message, std::move(samples));
  }
  diagnostics.add("excluded_samples",
                  kind + "s whose measure vanishes relative to their size; they contribute nothing",
                  std::move(samples));
}

void report_unreferenced(const PolygonMesh& mesh, Diagnostics& diagnostics) {
  std::vector<Index> unreferenced;
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (mesh.vertex_corners().size(v) == 0) unreferenced.push_back(v);
  report_unreferenced(std::move(unreferenced), diagnostics);
}

void report_unreferenced(std::vector<Index> unreferenced, Diagnostics& diagnostics) {
  diagnostics.add("unreferenced_vertices",
                  "vertices without a face: empty rows, excluded from every solve",
                  std::move(unreferenced));
}

void report_unreferenced(const PolyhedralMesh& mesh, Diagnostics& diagnostics) {
  std::vector<Index> unreferenced;
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (mesh.vertex_cell_corners().size(v) == 0) unreferenced.push_back(v);
  diagnostics.add("unreferenced_vertices",
                  "vertices without a cell: empty rows, excluded from every solve",
                  std::move(unreferenced));
}

void centre_points(const Points& points, Points& centred, Vec3& origin) {
  origin.setZero();
  if (points.rows() > 0)
    origin = ((points.colwise().minCoeff() + points.colwise().maxCoeff()) / 2).transpose();
  centred = points.rowwise() - origin.transpose();
}

}  // namespace carat
