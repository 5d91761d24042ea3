#pragma once
// Options as Python hands them over.

#include <optional>
#include <string>

#include "arrays.h"
#include "carat/apps/recommended.h"
#include "carat/operators/registry.h"

namespace carat::python {

/// How a mesh is discretized; what is not given is left to the library.
struct OperatorArguments {
  std::string application;  ///< "", "geodesics", "poisson", "eigenmodes", "curvature"
  std::string name;         ///< empty: what the application takes
  std::string virtual_point, weights, mass;
  std::optional<double> lambda, theta, tau;
  std::optional<bool> boundary_unknowns;
  bool keep_flipped = false, strict = false;
  py::object coefficient = py::none();       ///< a function of (n, 3) points, or None
  py::object cell_coefficient = py::none();  ///< (n_cells, 1 or 6) array, or None
  int threads = 0;

  static OperatorArguments from(const py::dict& arguments);
};

/// An operator with all that it is to be made with.
struct OperatorRequest {
  std::string name;
  DiscretizationOptions options;
};

OperatorRequest request(const PolygonMesh& mesh, const OperatorArguments& arguments);
OperatorRequest request(const PolyhedralMesh& mesh, const OperatorArguments& arguments);

/// A function of points that is written in Python, for any number of threads. Evaluated for all
/// samples of the operator at once; for others, as those of a preconditioner, one by one.
/// \throws InvalidOption  it does not return one number a point
template <class Mesh>
std::function<double(const Vec3&)> sampled(const py::object& function, const Mesh& mesh,
                                           const OperatorRequest& request);

/// The same, one by one from the start.
std::function<double(const Vec3&)> one_by_one(const py::object& function, const char* what);

/// keep-alive of a Python object that C++ may let go without Python's lock.
std::shared_ptr<py::object> shared_object(const py::object& object);

}  // namespace carat::python
