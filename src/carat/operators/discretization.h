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
  /// A sample whose measure is <= eps_rel * (its diameter)^2 is degenerate. At the default only
  /// rounding noise is.
  double eps_rel = 1e-14;
  /// K in div(K grad u), evaluated at the centroid of every sample; > 0. Empty: K = 1. It enters
  /// the stiffness (and so the laplacian), not gradient, divergence and mass.
  std::function<double(const Vec3&)> coefficient{};
  DiscretizationParts parts = DiscretizationParts::Gradient;
  int threads = 0;  ///< 0: all the machine has. No result depends on it.
};

/// How gradient samples lie on the surface. A sample's gradient has `dimension` components in its
/// own frame; a *part* is the piece of a sample within one face, where the frame has directions.
struct GradientFrames {
  struct Part {
    Index sample, face;
    double area;                                             ///< [length^2]
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> axes;  ///< columns: the frame's unit vectors
    std::array<Index, 3> vertices;                           ///< mesh vertices it touches, -1: none
  };
  std::vector<Part> parts;
};

/// The discrete operators of one mesh and method: an immutable value.
///
/// Integrated (weak) quantities: stiffness S is symmetric positive semidefinite,
/// laplacian L = -S = D G; its pointwise form is a solve with the mass M. With K = 1:
/// divergence D = -G^T M_s, M_s holding each sample's measure once a component.
struct Discretization {
  std::string name;        ///< registry name of the operator
  SparseMatrix stiffness;  ///< (V, V)  [1 on surfaces]
  SparseMatrix mass;       ///< (V, V), sum = area of the virtual refinement  [length^2]
  /// (dimension * samples, V); component k of sample s in row dimension * s + k.  [1/length]
  /// Empty unless asked for.
  SparseMatrix gradient;
  Index gradient_dimension = 0;
  Vector sample_measure;  ///< area of every sample, 0 where degenerate  [length^2]
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
  /// Integrated row sums of the mass.  [length^2]
  Vector lumped_mass() const { return mass * Vector::Ones(mass.cols()); }

  /// Area-weighted mean of sample vectors over each face, as 3-D vectors (n_faces, 3).
  /// \param vectors  one value a row of the gradient, e.g. gradient * u
  /// \throws InvalidOption  the frames were not asked for, or the size is wrong
  Points face_vectors(const Vector& vectors, Index n_faces) const;
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
