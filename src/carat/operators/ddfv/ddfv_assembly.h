#pragma once
// What discrete duality finite volumes have in common: one gradient a diamond over values at
// vertices, cells, faces and edges.

#include <vector>

#include "carat/mesh/polyhedral_mesh.h"
#include "carat/operators/discretization.h"

namespace carat {

/// S = G^T M_s G, row by row over the diamonds of an unknown. A derived class says which values a
/// diamond's gradient is made of.
class DdfvAssembly : public Assembly {
 public:
  void reassemble(const Points& points) override;

 protected:
  enum class Site { Vertex, Face, Cell, Edge };
  /// A diamond's gradient is the sum of value times g.
  struct Term {
    Site site;
    Index id;
    Vec3 g;  ///< [1/length]
  };
  /// The two parts of a diamond, in the cells below and above its face; -1: none.
  struct Diamond {
    double volume;  ///< <= 0 if it is degenerate
    Vec3 centroid;
    std::array<double, 2> parts;
    Index face;
  };

  DdfvAssembly(const char* name, const PolyhedralMesh& mesh, const DiscretizationOptions& options)
      : mesh_(mesh), options_(options) {
    result_.name = name;
  }

  /// Numbers the unknowns: after the vertices the blocks in this order.
  /// \param face, edge  flags of the faces and edges that are unknowns; empty: none
  struct Numbering {
    std::vector<Site> order;
    std::vector<bool> face, edge;
  };
  /// To be called by the constructor of the derived class.
  void build(Index n_samples, const Numbering& numbering);

  virtual void collect_terms(Index sample, std::vector<Term>& terms) const = 0;
  /// Sets the g of the terms, in the order of collect_terms().
  virtual Diamond diamond(Index sample, Term* terms) const = 0;
  /// Adds every unknown's part of the volume; through add_weight().
  virtual void add_weights(Vector& weights) const = 0;
  virtual std::string describe(Index sample) const = 0;
  /// Mesh vertices of a diamond, for means of gradients at vertices.
  virtual std::vector<Index> vertices_of(Index sample) const = 0;

  void add_weight(Vector& weights, Site site, Index id, double weight) const;
  std::vector<bool> boundary_edges() const;

  Vec3 position(Index v) const { return points_.row(v).transpose(); }
  Vec3 face_point(Index f) const { return face_points_.row(f).transpose(); }
  Vec3 cell_point(Index c) const { return cell_points_.row(c).transpose(); }
  const std::array<Index, 2>& edge(Index e) const { return mesh_.face_mesh().edges().vertices[e]; }
  bool has_cells(Index f) const {
    return mesh_.face_cells()[f].below >= 0 || mesh_.face_cells()[f].above >= 0;
  }

  PolyhedralMesh mesh_;
  DiscretizationOptions options_;

 private:
  /// Calls visit(unknown, weight): the value itself, or the mean of vertices that stands for it.
  template <class Visit>
  void for_unknowns(Site site, Index id, const Visit& visit) const;
  void number_unknowns(const Numbering& numbering);
  void find_columns(Index n_samples);
  void make_patterns();
  void compute_points(const Points& points);
  void compute_gradients();
  void assemble_stiffness();
  void collect_frames();
  void report();
  Eigen::Matrix3d conductivity(Index sample) const;

  std::vector<Index> face_unknown_, edge_unknown_;  // -1: the mean of its vertices
  Index first_cell_ = 0, n_unknowns_ = 0;
  Csr columns_;           // sample -> unknowns, ascending
  Csr unknown_samples_;   // unknown -> samples, ascending
  Array<double> values_;  // 3 for every entry of columns_
  Array<Diamond> diamonds_;
  Vec3 origin_ = Vec3::Zero();
  Points points_, face_points_, cell_points_;  // relative to the origin
};

}  // namespace carat
