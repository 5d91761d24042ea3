#pragma once
// What operators with one dense matrix a face have in common: alexa_wardetzky, de_goes, vem.

#include <array>

#include "carat/operators/discretization.h"
#include "carat/operators/surface/incidence.h"

namespace carat {

/// Faces as polygons in the plane normal to their vector area.
///
/// A derived class says what an entry of a face's stiffness and mass is; each is made of a few
/// numbers a corner, in O(1).
class PolygonAssembly : public Assembly {
 public:
  void reassemble(const Points& points) override;

 protected:
  using Vec2 = Eigen::Vector2d;

  PolygonAssembly(const char* name, const PolygonMesh& mesh, const DiscretizationOptions& options);

  struct Corner {
    Vec2 y;         ///< in the face's plane, from the mean of its vertices  [length]
    double height;  ///< above that plane                                    [length]
    Vec2 gradient;  ///< of the function that is 1 at the vertex, linear on the sides  [1/length]
  };
  struct Face {
    double area;         ///< length of the vector area, 0 if degenerate  [length^2]
    double coefficient;  ///< K
    Eigen::Matrix<double, 3, 2> axes;
  };

  const Csr& faces() const { return mesh_.faces(); }
  const Corner* corners_of(Index f) const { return corners_.data() + faces().begin(f); }
  Index previous(Index f, Index a) const { return a == 0 ? faces().size(f) - 1 : a - 1; }
  Index next(Index f, Index a) const { return a + 1 == faces().size(f) ? 0 : a + 1; }
  /// d^T d for the differences d along the sides: 2, -1 or 0; two sides may join two vertices.
  double side_differences(Index f, Index a, Index b) const {
    return (a == b ? 2.0 : 0.0) - (b == next(f, a) ? 1.0 : 0.0) - (a == next(f, b) ? 1.0 : 0.0);
  }

  /// After corners and faces are there.
  virtual void compute_terms() {}
  virtual void assemble_matrices() = 0;
  /// Vectors by default: three rows a face, the gradient of the corners' functions.
  virtual void make_gradient_pattern();
  virtual void assemble_gradient();

  PolygonMesh mesh_;
  DiscretizationOptions options_;
  SurfaceIncidence incidence_;
  Array<Corner> corners_;
  Array<Face> faces_;

 private:
  void measure_faces(const Points& points);
  void measure_face(const Points& points, Index f);
  void collect_frames();
  void report();
};

}  // namespace carat
