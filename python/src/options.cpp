#include "options.h"

#include <array>
#include <cstring>
#include <unordered_map>

#include "carat/base/error.h"
#include "modules.h"
#include "run.h"

namespace carat::python {
namespace {

template <class Value>
Value named(const char* option, const std::string& wanted,
            std::initializer_list<std::pair<const char*, Value>> table) {
  if (wanted.empty()) return table.begin()->second;
  std::string known;
  for (const auto& [name, value] : table) {
    if (wanted == name) return value;
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  throw InvalidOption(std::string(option) + "=\"" + wanted + "\": choose one of " + known);
}

Application application_of(const std::string& name) {
  return named<Application>("application", name,
                            {{"poisson", Application::Poisson},
                             {"geodesics", Application::Geodesics},
                             {"eigenmodes", Application::Eigenmodes},
                             {"curvature", Application::MeanCurvature}});
}

const SurfaceOperator& find_operator(const PolygonMesh&, const std::string& name) {
  return surface_operator(name);
}
const VolumeOperator& find_operator(const PolyhedralMesh&, const std::string& name) {
  return volume_operator(name);
}
std::string first_operator(const PolygonMesh&) { return surface_operators().front()->name; }
std::string first_operator(const PolyhedralMesh&) { return volume_operators().front()->name; }

template <class Mesh>
OperatorRequest request_for(const Mesh& mesh, const OperatorArguments& arguments) {
  OperatorRequest result;
  OperatorChoice choice{nullptr};
  if (!arguments.application.empty())
    choice = recommended_operator(application_of(arguments.application), mesh);
  result.name = !arguments.name.empty()  ? arguments.name
                : choice.name != nullptr ? choice.name
                                         : first_operator(mesh);
  const auto& entry = find_operator(mesh, result.name);
  if (!entry.options.virtual_vertex &&
      (!arguments.virtual_point.empty() || !arguments.weights.empty() || arguments.keep_flipped))
    throw InvalidOption("virtual_point, weights, keep_flipped: the operator " + result.name +
                        " has no virtual vertices; leave them out");
  DiscretizationOptions& options = result.options;
  options.virtual_vertex.point = named<VirtualPoint>("virtual_point", arguments.virtual_point,
                                                     {{"area", VirtualPoint::AreaMinimizer},
                                                      {"centroid", VirtualPoint::Centroid},
                                                      {"trace", VirtualPoint::TraceMinimizer}});
  options.virtual_vertex.weights = named<AffineWeights>(
      "weights", arguments.weights,
      {{"in-plane", AffineWeights::InPlane}, {"minimum-norm", AffineWeights::MinimumNorm}});
  options.virtual_vertex.keep_in_kernel = !arguments.keep_flipped;
  options.mass = named<MassKind>("mass", arguments.mass,
                                 {{"default", MassKind::Default},
                                  {"full", MassKind::Full},
                                  {"moment-exact", MassKind::MomentExact},
                                  {"lumped", MassKind::Lumped},
                                  {"voronoi", MassKind::Voronoi}});
  options.lambda = arguments.lambda;
  options.theta = arguments.theta;
  options.tau = arguments.tau;
  options.boundary_unknowns = arguments.boundary_unknowns;
  options.degenerate = arguments.strict ? DegeneratePolicy::Strict : DegeneratePolicy::Report;
  options.threads = arguments.threads;
  if (arguments.name.empty() && choice.name != nullptr) {
    if (arguments.mass.empty()) options.mass = choice.mass;
    if (!options.theta) options.theta = choice.theta;
  }
  if (!arguments.cell_coefficient.is_none()) {
    const auto cells = arguments.cell_coefficient.cast<In<double>>();
    options.cell_coefficient =
        Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
            cells.data(), cells.shape(0), cells.shape(1));
  }
  if (!arguments.coefficient.is_none())
    options.coefficient = sampled(arguments.coefficient, mesh, result);
  return result;
}

using Key = std::array<double, 3>;
struct KeyHash {
  std::size_t operator()(const Key& key) const {
    std::uint64_t bits[3];
    std::memcpy(bits, key.data(), sizeof bits);
    std::uint64_t hash = 0x9E3779B97F4A7C15u;
    for (const std::uint64_t b : bits) hash = (hash ^ b) * 0xFF51AFD7ED558CCDu, hash ^= hash >> 32;
    return hash;
  }
};

/// Values of a Python function at n points. With Python's lock.
std::vector<double> call(const py::object& function, const std::vector<Key>& points,
                         const char* what) {
  const auto n = static_cast<py::ssize_t>(points.size());
  py::array_t<double> array({n, py::ssize_t{3}});
  if (n > 0) std::memcpy(array.mutable_data(), points.data(), sizeof(Key) * points.size());
  const py::object given = function(array);
  const auto values = In<double>::ensure(given);
  if (!values) {
    PyErr_Clear();
    throw InvalidOption(std::string(what) + ": the function returned " +
                        py::cast<std::string>(py::str(py::type::of(given))) +
                        "; it has to return one number for each of the (n, 3) points it is given");
  }
  if (values.size() == 1) return std::vector<double>(points.size(), *values.data());
  if (values.size() != n)
    throw InvalidOption(std::string(what) + ": the function returned " +
                        std::to_string(values.size()) + " values for " + std::to_string(n) +
                        " points; it has to return one number a point");
  return {values.data(), values.data() + n};
}

}  // namespace

OperatorArguments OperatorArguments::from(const py::dict& d) {
  OperatorArguments a;
  const auto text = [&](const char* key) { return d[key].cast<std::string>(); };
  const auto number = [&](const char* key) {
    return d[key].is_none() ? std::nullopt : std::optional<double>(d[key].cast<double>());
  };
  a.application = text("application");
  a.name = text("operator");
  a.virtual_point = text("virtual_point");
  a.weights = text("weights");
  a.mass = text("mass");
  a.lambda = number("lambda");
  a.theta = number("theta");
  a.tau = number("tau");
  if (!d["boundary_unknowns"].is_none()) a.boundary_unknowns = d["boundary_unknowns"].cast<bool>();
  a.keep_flipped = d["keep_flipped"].cast<bool>();
  a.strict = d["strict"].cast<bool>();
  a.coefficient = d["coefficient"];
  a.cell_coefficient = d["cell_coefficient"];
  a.threads = d["threads"].cast<int>();
  return a;
}

OperatorRequest request(const PolygonMesh& mesh, const OperatorArguments& arguments) {
  return request_for(mesh, arguments);
}
OperatorRequest request(const PolyhedralMesh& mesh, const OperatorArguments& arguments) {
  return request_for(mesh, arguments);
}

std::shared_ptr<py::object> shared_object(const py::object& object) {
  return {new py::object(object), [](py::object* held) {
            if (!Py_IsInitialized()) return;
            const py::gil_scoped_acquire acquired;
            delete held;
          }};
}

std::function<double(const Vec3&)> one_by_one(const py::object& function, const char* what) {
  return [held = shared_object(function), what](const Vec3& x) {
    const py::gil_scoped_acquire acquired;
    return call(*held, {{x.x(), x.y(), x.z()}}, what).front();
  };
}

template <class Mesh>
std::function<double(const Vec3&)> sampled(const py::object& function, const Mesh& mesh,
                                           const OperatorRequest& request) {
  // One pass finds the points, in any order; values are then looked up by the points' bits.
  const auto points = run([mesh, request](Job&) {
    std::vector<Key> seen;
    DiscretizationOptions options = request.options;
    options.threads = 1;
    options.parts = DiscretizationParts::Gradient;
    options.coefficient = [&](const Vec3& x) {
      seen.push_back({x.x(), x.y(), x.z()});
      return 1.0;
    };
    discretize(mesh, request.name, options);
    return seen;
  });
  const std::vector<double> values = call(function, points, "coefficient");
  auto table = std::make_shared<std::unordered_map<Key, double, KeyHash>>();
  table->reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) table->emplace(points[i], values[i]);
  return [table = std::shared_ptr<const std::unordered_map<Key, double, KeyHash>>(table),
          other = one_by_one(function, "coefficient")](const Vec3& x) {
    const auto found = table->find({x.x(), x.y(), x.z()});
    return found != table->end() ? found->second : other(x);
  };
}

template std::function<double(const Vec3&)> sampled(const py::object&, const PolygonMesh&,
                                                    const OperatorRequest&);
template std::function<double(const Vec3&)> sampled(const py::object&, const PolyhedralMesh&,
                                                    const OperatorRequest&);

}  // namespace carat::python
