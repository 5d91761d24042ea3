#pragma once
// The discrete operators of one mesh, consistent with each other.

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "carat/base/diagnostics.h"
#include "carat/base/types.h"
#include "carat/kernels/virtual_vertex.h"
#include "carat/mesh/polygon_mesh.h"

namespace carat {

/// What to do with elements that have no measure.
enum class DegeneratePolicy {
  Report,  ///< leave them out, list them in the diagnostics
  Strict,  ///< throw DegenerateElement
};

/// What to compute beyond stiffness and mass.
enum class DiscretizationParts {
  Matrices,  ///< stiffness and mass
  Gradient,  ///< also the gradient and its sample measures; the divergence follows from them
  Frames,    ///< also what turns gradients into 3-D vectors
};

struct DiscretizationOptions {
  VirtualVertexRule virtual_vertex{};
  /// Row sums instead of the operator's own mass matrix.
  bool lumped_mass = false;
  DegeneratePolicy degenerate = DegeneratePolicy::Report;
  /// A sample whose measure is <= eps_rel * (its diameter)^2, in volumes ^3, is degenerate. At the
  /// default only rounding noise is.
  double eps_rel = 1e-14;
  /// K in div(K grad u), evaluated at the centroid of every sample; > 0. Empty: K = 1. It enters
  /// the stiffness (and so the laplacian), not gradient, divergence and mass.
  std::function<double(const Vec3&)> coefficient{};
  /// Volumes: K of every cell, a further factor. (n_cells, 1): scalars > 0; (n_cells, 6): symmetric
  /// positive definite tensors xx, yy, zz, xy, yz, xz. Empty: K = 1.
  Matrix cell_coefficient{};
  DiscretizationParts parts = DiscretizationParts::Gradient;
  int threads = 0;  ///< 0: all the machine has. No result depends on it.
};

/// How gradient samples lie in the mesh. A *part* is the piece of a sample within one element: a
/// face of a surface, a cell of a volume.
struct GradientFrames {
  struct Part {
    double measure;  ///< area or volume  [length^2, length^3]
    Index sample, element;
    std::array<Index, 3> vertices;  ///< mesh vertices it touches, -1: none
  };
  std::vector<Part> parts;
  /// One a part: the unit vectors that a sample's two components belong to. Empty where gradients
  /// have three components: these are along x, y, z.
  std::vector<Eigen::Matrix<double, 3, 2>> axes;
};

/// The discrete operators of one mesh and method: an immutable value.
///
/// Integrated (weak) quantities: stiffness S is symmetric positive semidefinite,
/// laplacian L = -S = D G; its pointwise form is a solve with the mass M. With K = 1:
/// divergence D = -G^T M_s, M_s holding each sample's measure once a component.
struct Discretization {
  std::string name;        ///< registry name of the operator
  SparseMatrix stiffness;  ///< (V, V)  [1 on surfaces, length in volumes]
  /// (V, V), sum = area or volume of the virtual refinement  [length^2, length^3]
  SparseMatrix mass;
  /// (dimension * samples, V); component k of sample s in row dimension * s + k.  [1/length]
  /// Empty unless asked for.
  SparseMatrix gradient;
  Index gradient_dimension = 0;
  Vector sample_measure;  ///< area or volume of every sample, 0 where degenerate
  GradientFrames frames;  ///< empty unless asked for
  Diagnostics diagnostics;

  Index n_vertices() const { return static_cast<Index>(stiffness.rows()); }
  Index n_samples() const { return static_cast<Index>(sample_measure.size()); }

  /// L = -S.
  SparseMatrix laplacian() const { return -stiffness; }
  /// D = -G^T M_s, (V, dimension * samples).  [BBA21 (20)]
  /// \throws InvalidOption  the gradient was not asked for
  SparseMatrix divergence() const;
  /// D X without forming D. \param vectors  one gradient-like value a row of the gradient
  Vector apply_divergence(const Vector& vectors) const;
  /// Integrated row sums of the mass.
  Vector lumped_mass() const { return mass * Vector::Ones(mass.cols()); }

  /// Mean of sample vectors by area or volume over each element, as 3-D vectors (n_elements, 3).
  /// \param vectors     one value a row of the gradient, e.g. gradient * u
  /// \param n_elements  faces of the surface or cells of the volume
  /// \throws InvalidOption  the frames were not asked for, or the size is wrong
  Points element_vectors(const Vector& vectors, Index n_elements) const;
  /// The same for vertices: mean over the parts that touch the vertex.
  Points vertex_vectors(const Vector& vectors) const;
};

/// The two phases of a discretization. The constructor of an implementation runs the symbolic one:
/// sparsity from connectivity alone; update() runs the numeric one and can be repeated with moved
/// vertices.
class Assembly {
 public:
  virtual ~Assembly() = default;
  /// \param points  (V, 3) positions  [length]
  /// \throws DegenerateElement  with DegeneratePolicy::Strict
  /// \throws InvalidOption      the coefficient is not a positive finite number somewhere
  virtual void update(const Points& points) = 0;
  const Discretization& discretization() const { return result_; }
  /// Moves the result out; the assembly is then spent.
  Discretization release() { return std::move(result_); }

 protected:
  Discretization result_;
};

}  // namespace carat
