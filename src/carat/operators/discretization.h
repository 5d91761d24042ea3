#pragma once
// The discrete operators of one mesh, consistent with each other.

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "carat/assembly/element_product.h"
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

/// What to compute.
enum class DiscretizationParts {
  /// The stiffness, as for a preconditioner. Operators that save nothing by it give Matrices.
  Stiffness,
  Matrices,  ///< stiffness and mass
  Gradient,  ///< also the gradient and its sample measures; the divergence follows from them
  Frames,    ///< also what turns gradients into 3-D vectors
};

/// What stiffness and mass are given as.
enum class OperatorForm {
  Matrices,
  /// Products with them, which need less memory and are sooner made than the matrices; faster
  /// products where elements have many vertices. The matrices stay empty.
  Products,
};

/// Which mass matrix. An operator has one or several of them.
enum class MassKind {
  Default,  ///< the first of the operator's own, see OperatorEntry::options
  Full,     ///< the operator's own inner product: linear elements, or P^T M P
  /// P^T M P with shares of every diamond that integrate linear functions exactly, see tau
  MomentExact,
  Lumped,   ///< the row sums of the full one
  Voronoi,  ///< diagonal: mixed Voronoi areas (Meyer, Desbrun, Schroeder, Barr 2003)
};

/// An option that an operator has no use for is an error; see OperatorEntry::options.
struct DiscretizationOptions {
  VirtualVertexRule virtual_vertex{};
  MassKind mass = MassKind::Default;
  /// Weight of the stabilising term, > 0; default: the operator's own.
  std::optional<double> lambda{};
  /// Keep values of boundary faces and edges as unknowns, or eliminate them as means of their
  /// vertices; default: the operator's own.
  std::optional<bool> boundary_unknowns{};
  /// Stabilised diamonds, in [0, 1]: stiffness theta S_diamond + (1 - theta) S_bunge; default: the
  /// operator's own.
  std::optional<double> theta{};
  /// The moment-exact mass, in [0, 1]: 0 splits a diamond at its base, 1 about the axis from tip to
  /// tip; default: the operator's own.
  std::optional<double> tau{};
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
  /// Of a part of a mesh, see PartNumbers::own_interfaces: which edges of a surface, faces of a
  /// volume bring their samples. Those of the others are left out without being degenerate, so that
  /// the matrices of all parts add up. Empty: all.
  std::vector<bool> own_interfaces{};
  DiscretizationParts parts = DiscretizationParts::Gradient;
  OperatorForm form = OperatorForm::Matrices;
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

/// Unknowns beyond the vertices, numbered after them: blocks of values at faces, cells, edges.
struct ExtraUnknowns {
  enum class Site { Face, Cell, Edge };
  struct Block {
    Site site;
    std::vector<Index> elements;  ///< their ids in the mesh; edges as in its face_mesh()
  };
  std::vector<Block> blocks;
  Points positions;  ///< one a row: where it is a value of the function  [length]
  /// Row k: the vertices of the boundary face or edge that unknown k lies on; empty inside.
  Csr boundary_vertices;

  Index size() const { return static_cast<Index>(positions.rows()); }
};

/// Gradients that are differences along the sides of faces: one value a side instead of components
/// of a vector. Empty where gradients are vectors.
struct OneForms {
  Array<Index> first;          ///< sample -> its first row of the gradient; last: number of rows
  SparseMatrix inner_product;  ///< (rows, rows), one positive semidefinite block a sample
  SparseMatrix sharp;          ///< (3 * samples, rows): the vector of a sample  [1/length]
  SparseMatrix flat;           ///< (rows, 3 * samples): the differences of a vector  [length]
};

/// Integrals of vectors over elements or about vertices: x, y, z, and the measure.
using VectorSums = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;

/// The discrete operators of one mesh and method: an immutable value.
///
/// Integrated (weak) quantities: stiffness S is symmetric positive semidefinite,
/// laplacian L = -S; its pointwise form is a solve with the mass M. With K = 1:
/// divergence D = -G^T M_s, M_s holding each sample's measure once a component or, for one-forms,
/// their inner product; L = D G for operators without a stabilising term of their own.
struct Discretization {
  std::string name;               ///< registry name of the operator
  DiscretizationOptions options;  ///< those it was made with, defaults settled
  SparseMatrix stiffness;  ///< (N, N), N = V + extra unknowns  [1 on surfaces, length in volumes]
  /// (N, N), sum = area or volume of the virtual refinement  [length^2, length^3]
  SparseMatrix mass;
  /// The same operators where they were asked for as products; else null.
  std::shared_ptr<const ElementProduct> stiffness_product, mass_product;
  ExtraUnknowns extra;  ///< none for most operators
  /// (dimension * samples, N); component k of sample s in row dimension * s + k.  [1/length]
  /// One-forms: (rows, N), differences.  [1]
  /// Empty unless asked for, and for operators that define none.
  SparseMatrix gradient;
  Index gradient_dimension = 0;  ///< 1: one-forms
  /// How many of a sample's last components are no part of its vector but jumps between its parts,
  /// scaled so that L = D G: 0 for most operators, 1 for stabilised diamonds.
  Index jump_components = 0;
  double jump_weight = 0;  ///< part of the jumps' energy that is in the stiffness, 0 .. 1
  OneForms one_forms;
  Vector sample_measure;  ///< area or volume of every sample, 0 where degenerate
  GradientFrames frames;  ///< empty unless asked for
  Diagnostics diagnostics;

  Index n_unknowns() const {
    return stiffness_product ? stiffness_product->rows() : static_cast<Index>(stiffness.rows());
  }
  Index n_vertices() const { return n_unknowns() - extra.size(); }
  Index n_samples() const { return static_cast<Index>(sample_measure.size()); }
  bool is_one_form() const { return gradient_dimension == 1; }
  /// First row of a sample in the gradient; of the one past the last: number of rows.
  Eigen::Index first_row(Index sample) const {
    return is_one_form() ? one_forms.first[static_cast<std::size_t>(sample)]
                         : Eigen::Index{gradient_dimension} * sample;
  }

  /// L = -S.
  /// \throws InvalidOption  there is no matrix: OperatorForm::Products
  SparseMatrix laplacian() const;
  /// M x in either form. \param x  one value an unknown
  Vector apply_mass(const Vector& x) const {
    return mass_product ? *mass_product * x : Vector(mass * x);
  }
  /// D = -G^T M_s, (N, rows of the gradient).  [BBA21 (20)]
  /// \throws InvalidOption  the gradient was not asked for
  SparseMatrix divergence() const;
  /// D X without forming D. \param vectors  one gradient-like value a row of the gradient
  Vector apply_divergence(const Vector& vectors) const;
  /// Scales every sample to unit length; those without a length become zero. A one-form is replaced
  /// by the differences of its unit vector: what no vector has would else count as length.
  /// \return flags of the samples that became zero
  std::vector<bool> normalise_samples(Vector& vectors) const;
  /// What a field of one unit vector an element is for the samples: every sample's part-weighted
  /// mean, and the jumps between its parts scaled so that the divergence of the result is that of
  /// the field on the single parts.
  /// \param vectors  one value a row of the gradient; the field is the direction of its element
  ///                 means, zero in elements where these vanish
  /// \throws InvalidOption  samples span several elements, and their jumps are not in the gradient
  ///                        (diamond) or have no frame (volumes): lacks_element_directions()
  Vector element_directions(const Vector& vectors) const;
  /// The same from the field itself. \param field  one unit vector or zero an element
  Vector directions_of_field(const Points& field) const;
  /// \return empty, or why element_directions() cannot be had
  std::string lacks_element_directions() const;
  /// Integrated row sums of the mass.
  Vector lumped_mass() const { return apply_mass(Vector::Ones(n_unknowns())); }

  /// Mean of sample vectors by area or volume over each element, as 3-D vectors (n_elements, 3).
  /// \param vectors     one value a row of the gradient, e.g. gradient * u
  /// \param n_elements  faces of the surface or cells of the volume
  /// \throws InvalidOption  the frames were not asked for, or the size is wrong
  Points element_vectors(const Vector& vectors, Index n_elements) const;
  /// The same for vertices: mean over the parts that touch the vertex.
  Points vertex_vectors(const Vector& vectors) const;
  /// What these means are quotients of, which adds up over the parts of a mesh.
  VectorSums element_sums(const Vector& vectors, Index n_elements) const;
  VectorSums vertex_sums(const Vector& vectors) const;
};

/// The means of element_sums() and vertex_sums(); zero where nothing has been added.
Points means_of_sums(const VectorSums& sums);
/// Their directions: unit vectors, zero where the mean is.
Points directions_of_sums(const VectorSums& sums);

/// The two phases of a discretization. The constructor of an implementation runs the symbolic one:
/// sparsity from connectivity alone; reassemble() runs the numeric one and can be repeated with
/// moved vertices.
class Assembly {
 public:
  virtual ~Assembly() = default;
  /// \param points  (V, 3) positions  [length]
  /// \throws DegenerateElement  with DegeneratePolicy::Strict
  /// \throws InvalidOption      the coefficient is not a positive finite number somewhere
  virtual void reassemble(const Points& points) = 0;
  const Discretization& discretization() const { return result_; }
  /// Keeps with the result what it is made with.
  void set_options(DiscretizationOptions options) { result_.options = std::move(options); }
  /// Moves the result out; the assembly is then spent.
  Discretization release() { return std::move(result_); }

 protected:
  /// Of another assembly that this one consists of.
  static Discretization& result_of(Assembly& part) { return part.result_; }
  Discretization result_;
};

}  // namespace carat
