#include "carat/report/claims.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>

#include "carat/apps/poisson.h"
#include "carat/base/error.h"
#include "carat/report/franke.h"
#include "carat/report/measures.h"
#include "carat/report/volume_measures.h"

namespace carat {
namespace {

using namespace measures;

// All eigenvalues of this many rows take about a minute.
constexpr Index kMaxRows = 4000;
// A row adds up to some hundreds of terms.
constexpr double kRounding = 200 * kEps;
// Below this an eigenvalue relative to the largest is one of the kernel: the next ones are of the
// order of (h / diameter)^2 on meshes of some thousand vertices.
constexpr double kZeroEigenvalue = 1e-9;
constexpr double kLinear = 1e-11;
constexpr double kEqual = 1e-12;
// Between first and second order. In volumes three coarse levels, where slopes still grow: those of
// vem start at 1.26 on cube-pyramids, at 1.3 to 1.6 elsewhere, and reach 1.8 to 1.9 two levels
// further, where its stabilising term no longer outweighs the rest; all others stay above 1.4.
constexpr double kSecondOrderOnSurfaces = 1.5, kSecondOrderInVolumes = 1.2;

template <class Mesh>
constexpr bool kVolume = std::is_same_v<Mesh, PolyhedralMesh>;

template <class Mesh>
double measure_of_refinement(const Mesh& mesh) {
  if constexpr (kVolume<Mesh>)
    return refinement_volume(mesh);
  else
    return refinement_area(mesh);
}

bool contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

/// Turned and translated.
template <class Mesh>
Mesh moved(const Mesh& mesh) {
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(1.1, Vec3(0.3, -0.8, 0.5).normalized()).toRotationMatrix();
  const Points points =
      (mesh.points() * rotation.transpose()).rowwise() + Eigen::RowVector3d(3, -7, 11);
  return mesh.with_points(points);
}

/// Whether S couples more than the vertices of common faces, in volumes cells.
template <class Mesh>
double entries_beyond_elements(const Mesh& mesh, const SparseMatrix& s) {
  const auto elements_of = [&](Index v) {
    if constexpr (kVolume<Mesh>) {
      std::vector<Index> cells;
      for (const Index c : mesh.vertex_cell_corners().row(v))
        cells.push_back(mesh.corner_cells()[static_cast<std::size_t>(c)]);
      return cells;
    } else {
      std::vector<Index> faces;
      for (const Index c : mesh.vertex_corners().row(v))
        faces.push_back(mesh.corner_faces()[static_cast<std::size_t>(c)]);
      return faces;
    }
  };
  double beyond = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    std::vector<Index> mine = elements_of(v);
    std::sort(mine.begin(), mine.end());
    for (SparseMatrix::InnerIterator entry(s, v); entry; ++entry) {
      if (entry.col() >= mesh.n_vertices()) continue;
      const std::vector<Index> theirs = elements_of(static_cast<Index>(entry.col()));
      beyond += std::none_of(theirs.begin(), theirs.end(), [&](Index e) {
        return std::binary_search(mine.begin(), mine.end(), e);
      });
    }
  }
  return beyond;
}

/// The largest positive entry off the diagonal in rows of inner vertices, over the row's diagonal.
template <class Mesh>
double positive_coupling(const Mesh& mesh, const SparseMatrix& s) {
  const std::vector<bool> inner = inner_vertices(mesh);
  double worst = 0;
  for (Index row = 0; row < mesh.n_vertices(); ++row) {
    if (!inner[static_cast<std::size_t>(row)]) continue;
    double diagonal = 0, largest = 0;
    for (SparseMatrix::InnerIterator entry(s, row); entry; ++entry)
      (entry.col() == row ? diagonal : largest) =
          entry.col() == row ? entry.value() : std::max(largest, entry.value());
    if (diagonal > 0) worst = std::max(worst, largest / diagonal);
  }
  return worst;
}

// Problems with a known solution.
double third_harmonic(const Vec3& x) {
  return x.y() * (4 * x.z() * x.z() - x.x() * x.x() - x.y() * x.y());
}

/// Values at all unknowns.
template <class Mesh, class Function>
Vector values_at(const Mesh& mesh, const Discretization& d, const Function& function) {
  Vector values(d.n_unknowns());
  for (Index v = 0; v < mesh.n_vertices(); ++v) values[v] = function(mesh.point(v));
  for (Index k = 0; k < d.extra.size(); ++k)
    values[mesh.n_vertices() + k] = function(Vec3(d.extra.positions.row(k).transpose()));
  return values;
}

/// Root mean square error at the vertices of Franke's function with Dirichlet data, or on spheres
/// of a harmonic up to constants.
template <class Mesh>
double poisson_error(const Mesh& mesh, const Discretization& d, bool sphere) {
  const Index n = mesh.n_vertices();
  if (sphere) {
    const Vector y = values_at(mesh, d, third_harmonic);
    Vector e = (Poisson(mesh, d).solve(y).values - y / 12).head(n);
    e.array() -= e.mean();
    return e.norm() / std::sqrt(n);
  }
  const auto exact = kVolume<Mesh> ? franke_3d : franke;
  const auto laplacian = kVolume<Mesh> ? franke_3d_laplacian : franke_laplacian;
  BoundaryConditions conditions;
  const std::vector<bool> boundary = boundary_vertices(mesh);
  for (Index v = 0; v < n; ++v)
    if (boundary[static_cast<std::size_t>(v)]) {
      conditions.dirichlet_vertices.push_back(v);
      conditions.dirichlet_values.push_back(exact(mesh.point(v)));
    }
  conditions.dirichlet_function = exact;
  const Vector u = Poisson(mesh, d, conditions).solve(-values_at(mesh, d, laplacian)).values;
  // Over the inner vertices: on coarse meshes most others lie on the boundary, where the error is 0
  // by definition.
  const double inner = static_cast<double>(std::count(boundary.begin(), boundary.end(), false));
  return (u - values_at(mesh, d, exact)).head(n).norm() / std::sqrt(inner);
}

template <class Entry, class Family, class Mesh>
class Measurement {
 public:
  Measurement(const Entry& entry, const Family& family, const ClaimOptions& options)
      : entry_(entry),
        family_(family),
        options_(options),
        mesh_(family.generate({.level = options.level, .jitter = options.jitter, .seed = 7})) {}

  std::vector<ClaimResult> run();

 private:
  /// A defect that is at most `limit` where the claim holds.
  void defect(const char* claim, bool promised, double measured, double limit) {
    add(claim, promised, measured <= limit, measured, limit);
  }
  void add(const char* claim, bool promised, bool holds, double measured, double limit) {
    results_.push_back({claim,
                        promised ? (holds ? Verdict::Kept : Verdict::Violated)
                                 : (holds ? Verdict::Holds : Verdict::Denied),
                        measured, limit});
  }
  void none(const char* claim) { results_.push_back({claim}); }

  Discretization discretize(const Mesh& mesh, MassKind mass = MassKind::Default,
                            DiscretizationParts parts = DiscretizationParts::Matrices) const {
    const auto assembly = entry_.prepare(
        mesh, {.mass = mass, .eps_rel = 1e-14, .parts = parts, .threads = options_.threads});
    assembly->reassemble(mesh.points());
    return assembly->release();
  }
  bool flat() const { return kVolume<Mesh> || contains(family_.name, "plane-"); }
  bool simplices() const { return contains(family_.name, kVolume<Mesh> ? "-tets" : "-triangles"); }

  void measure_spectrum(const Discretization& d);
  void measure_linear_functions(const Discretization& d);
  void measure_gradient(const Discretization& d);
  void measure_mass(const Discretization& d);
  void measure_maximum_principle();
  void measure_simplices(const Discretization& d);
  void measure_invariance(const Discretization& d);
  void measure_convergence();

  const Entry& entry_;
  const Family& family_;
  ClaimOptions options_;
  Mesh mesh_;
  std::vector<ClaimResult> results_;
};

template <class Entry, class Family, class Mesh>
void Measurement<Entry, Family, Mesh>::measure_spectrum(const Discretization& d) {
  const Vector values = relative_eigenvalues(d.stiffness);
  const Index n_kernel = static_cast<Index>((values.cwiseAbs().array() < kZeroEigenvalue).count());
  defect("semidefinite", entry_.claims.semidefinite, std::max(0.0, -values[0]), kRounding);
  const bool constants = row_sum_defect(d.stiffness) <= kRounding;
  add("kernel", entry_.claims.kernel_is_constants, constants && n_kernel == 1, n_kernel, 1);
}

template <class Entry, class Family, class Mesh>
void Measurement<Entry, Family, Mesh>::measure_linear_functions(const Discretization& d) {
  if (!flat()) return none("linear_precision");
  Points points(d.n_unknowns(), 3);
  points.topRows(mesh_.n_vertices()) = mesh_.points();
  if (d.extra.size() > 0) points.bottomRows(d.extra.size()) = d.extra.positions;
  std::vector<bool> rows = inner_vertices(mesh_);
  rows.resize(static_cast<std::size_t>(d.n_unknowns()), false);
  for (Index k = 0; k < d.extra.size(); ++k)
    rows[static_cast<std::size_t>(mesh_.n_vertices() + k)] = d.extra.boundary_vertices.size(k) == 0;
  // Where boundary values are eliminated, cells at the boundary see means of vertices in the place
  // of values at points: exact for linear functions as well.
  defect("linear_precision", entry_.claims.linear_precision,
         linear_precision_defect(d.stiffness, points, rows), kLinear);
}

template <class Entry, class Family, class Mesh>
void Measurement<Entry, Family, Mesh>::measure_gradient(const Discretization& d) {
  if (!entry_.claims.gradient) {
    none("gradient");
    return none("divergence_of_gradient");
  }
  if (flat()) {
    const Vec3 c(0.6, -1.3, kVolume<Mesh> ? 0.4 : 0.0);
    const Vector g =
        d.gradient * values_at(mesh_, d, [&](const Vec3& x) { return c.dot(x - mesh_.point(0)); });
    const Index n = [&] {
      if constexpr (kVolume<Mesh>)
        return mesh_.n_cells();
      else
        return mesh_.n_faces();
    }();
    const Points vectors = d.element_vectors(g, n);
    // Values of size 1 differ over heights of h / condition, h > 0.01 here.
    defect("gradient", true,
           (vectors.rowwise() - c.transpose()).rowwise().norm().maxCoeff() / c.norm(),
           10 * kEps / 0.01 * condition(mesh_));
  } else {
    none("gradient");
  }
  defect("divergence_of_gradient", entry_.claims.divergence_of_gradient,
         factorisation_defect(d.stiffness, d.divergence(), d.gradient),
         kRounding * condition(mesh_));
}

template <class Entry, class Family, class Mesh>
void Measurement<Entry, Family, Mesh>::measure_mass(const Discretization& d) {
  const double whole = measure_of_refinement(mesh_);
  defect("total_mass", entry_.claims.total_mass, mass_defect(d.mass, whole), 1e-12);
  // The worst of all its masses.
  double smallest = 1;
  for (const MassKind mass : entry_.options.masses)
    smallest = std::min(smallest, relative_eigenvalues(discretize(mesh_, mass).mass)[0]);
  add("positive_mass", entry_.claims.positive_mass, smallest > 0, smallest, 0);
}

template <class Entry, class Family, class Mesh>
void Measurement<Entry, Family, Mesh>::measure_maximum_principle() {
  // Regular triangles and tetrahedra of the unit square and cube are Delaunay meshes; bisected ones
  // are not. Nothing is promised on those.
  const Mesh regular = family_.generate({.level = options_.level});
  const bool delaunay = simplices() && flat() && !contains(family_.name, "ball-") &&
                        !contains(family_.name, "adaptive");
  defect("maximum_principle", entry_.claims.maximum_principle && delaunay,
         positive_coupling(regular, discretize(regular).stiffness), kRounding);
}

template <class Entry, class Family, class Mesh>
void Measurement<Entry, Family, Mesh>::measure_simplices(const Discretization& d) {
  if (!simplices() || !entry_.claims.vertex_unknowns) return none("equals_cotan");
  const Discretization linear = carat::discretize(mesh_, kVolume<Mesh> ? "primal_tet" : "cotan",
                                                  {.parts = DiscretizationParts::Matrices});
  defect("equals_cotan", entry_.claims.equals_cotan_on_simplices,
         difference(d.stiffness, linear.stiffness), kEqual * condition(mesh_));
}

template <class Entry, class Family, class Mesh>
void Measurement<Entry, Family, Mesh>::measure_invariance(const Discretization& d) {
  const double tolerance = 100 * kRounding * condition(mesh_);
  const Discretization m = discretize(moved(mesh_));
  defect("rigid_motion", true,
         std::max(difference(m.stiffness, d.stiffness), difference(m.mass, d.mass)), tolerance);
  const double scale = 1e-9;
  const Discretization s = discretize(mesh_.with_points(scale * mesh_.points()));
  const double factor = kVolume<Mesh> ? 1 / scale : 1;
  defect("scale", true, difference(factor * s.stiffness, d.stiffness), tolerance);
}

template <class Entry, class Family, class Mesh>
void Measurement<Entry, Family, Mesh>::measure_convergence() {
  const std::string name = family_.name;
  const bool sphere = contains(name, "sphere-");
  if (!sphere && !contains(name, "plane-") && !contains(name, "cube-")) return none("second_order");
  const int last = kVolume<Mesh> ? 2 : 3;
  std::vector<double> h, error;
  for (int level = last - 2; level <= last; ++level) {
    const Mesh mesh = family_.generate({.level = level});
    double elements = 0;
    if constexpr (kVolume<Mesh>)
      elements = mesh.n_cells();
    else
      elements = mesh.n_faces();
    h.push_back(std::pow(elements, kVolume<Mesh> ? -1.0 / 3 : -0.5));
    error.push_back(poisson_error(mesh, discretize(mesh), sphere));
  }
  const double slope = log_slope(h, error);
  const double least = kVolume<Mesh> ? kSecondOrderInVolumes : kSecondOrderOnSurfaces;
  add("second_order", entry_.claims.second_order, slope >= least, slope, least);
}

template <class Entry, class Family, class Mesh>
std::vector<ClaimResult> Measurement<Entry, Family, Mesh>::run() {
  const auto refuse_beyond = [&](Index n) {
    if (n > kMaxRows)
      throw InvalidOption("level " + std::to_string(options_.level) + " of " + family_.name +
                          " has " + std::to_string(n) + " unknowns with " + entry_.name +
                          "; all eigenvalues are computed, of at most " + std::to_string(kMaxRows) +
                          ": choose a coarser level");
  };
  refuse_beyond(mesh_.n_vertices());
  const Discretization d = discretize(mesh_, MassKind::Default, DiscretizationParts::Frames);
  refuse_beyond(d.n_unknowns());
  defect("symmetric", entry_.claims.symmetric, std::max(asymmetry(d.stiffness), asymmetry(d.mass)),
         kRounding);
  measure_spectrum(d);
  measure_linear_functions(d);
  measure_gradient(d);
  measure_mass(d);
  measure_maximum_principle();
  measure_simplices(d);
  defect("element_local", entry_.claims.face_local, entries_beyond_elements(mesh_, d.stiffness), 0);
  measure_invariance(d);
  measure_convergence();
  return std::move(results_);
}

template <class Mesh, class Entry, class Family>
std::vector<ClaimResult> measure(const Entry& entry, const Family& family,
                                 const ClaimOptions& options) {
  const bool simplices = contains(family.name, kVolume<Mesh> ? "-tets" : "-triangles");
  if (entry.claims.simplices_only && !simplices) return {};
  return Measurement<Entry, Family, Mesh>(entry, family, options).run();
}

}  // namespace

const std::vector<Claim>& claims() {
  static const std::vector<Claim> list = {
      {"symmetric", "S and M are symmetric"},
      {"semidefinite", "S has no negative eigenvalue"},
      {"kernel", "S annihilates the constants and nothing else: dimension of its kernel"},
      {"linear_precision", "S annihilates linear functions at inner vertices"},
      {"gradient", "the gradient of linear functions is exact"},
      {"divergence_of_gradient", "L = D G"},
      {"total_mass", "M sums to the area, the volume of the virtual refinement"},
      {"positive_mass", "all masses of the operator are positive definite: least eigenvalue"},
      {"maximum_principle", "no positive entry off the diagonal at inner vertices"},
      {"equals_cotan", "S is that of linear elements on triangles, tetrahedra"},
      {"element_local", "only vertices of common faces, cells are coupled: entries beyond"},
      {"rigid_motion", "S and M do not change when the mesh is moved and turned"},
      {"scale", "S scales with the mesh, by 1e-9"},
      {"second_order", "Poisson's equation: slope of the error at the vertices"},
  };
  return list;
}

const char* verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::Kept:
      return "kept";
    case Verdict::Denied:
      return "denied";
    case Verdict::Holds:
      return "holds";
    case Verdict::Violated:
      return "violated";
    default:
      return "none";
  }
}

std::vector<ClaimResult> measure_claims(const SurfaceOperator& entry, const FamilyEntry& family,
                                        const ClaimOptions& options) {
  return measure<PolygonMesh>(entry, family, options);
}

std::vector<ClaimResult> measure_claims(const VolumeOperator& entry,
                                        const VolumeFamilyEntry& family,
                                        const ClaimOptions& options) {
  return measure<PolyhedralMesh>(entry, family, options);
}

}  // namespace carat
