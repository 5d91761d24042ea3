// Polygon Laplacian Made Simple: Bunge, Herholz, Kazhdan, Botsch 2020, on polyhedra.
// Linear elements on virtual tetrahedra (x_i, x_{i+1}, x_f, x_c), with the virtual vertices
// prolonged from the cells' own: S = P^T S_tet P, M = P^T M_tet P.

#include <algorithm>
#include <atomic>

#include "carat/assembly/cell_assembly.h"
#include "carat/assembly/pattern.h"
#include "carat/base/error.h"
#include "carat/kernels/tetrahedron.h"
#include "carat/operators/common.h"
#include "carat/operators/linear_tets.h"
#include "carat/operators/registry.h"
#include "carat/operators/volume/incidence.h"
#include "carat/prolongation/virtual_cells.h"

namespace carat {
namespace {

// Volumes below this part of the cubed size are rounding noise of the products that make them.
constexpr double kNoise = 1e-13;

class VolumeBungeAssembly final : public Assembly {
 public:
  VolumeBungeAssembly(const PolyhedralMesh& mesh, const DiscretizationOptions& options);
  void reassemble(const Points& points) override;

 private:
  /// A virtual tetrahedron: the corner of its face and the next. On the side above a face, i and j
  /// change places, so that the order of its points is the same on both sides.
  struct Place {
    Index tet, cell, face, corner, next;
    bool above;
  };

  // Symbolic.
  void number_tets();
  void make_gradient_pattern();
  Index collect_columns(Index c, Index* columns) const;

  // Numeric.
  bool compute_tets();
  void fill_forms();
  struct Scratch;
  void fill_cell(Index c, Scratch& scratch);
  void assemble_gradient();
  void collect_frames();
  void report();

  /// Calls visit(place) for the virtual tetrahedra of a cell in the order of their numbers.
  template <class Visit>
  void for_tets(Index c, const Visit& visit) const;
  Tetrahedron virtual_tet(const Place& at) const;
  Vec3 position(Index v) const { return points_.row(v).transpose(); }
  Index vertex(Index corner) const { return mesh_.face_mesh().faces().indices[corner]; }
  Index n_tets() const { return first_tet_.back(); }

  PolyhedralMesh mesh_;
  DiscretizationOptions options_;
  bool with_mass_ = options_.parts != DiscretizationParts::Stiffness;
  bool lumped_ = with_mass_ && options_.mass == MassKind::Lumped;
  VolumeIncidence incidence_;
  Array<Index> first_tet_;  // cell -> its first virtual tetrahedron, n_cells + 1 numbers
  VirtualCells virtuals_;
  CellForm stiffness_, mass_;
  bool loose_faces_;  // some face has no cell
  bool tets_;         // all cells are tetrahedra, K constant in each: the closed form serves
  Array<LinearTet> linear_tets_;
  bool closed_form_ = false;  // the last reassembly took it
  Vec3 origin_ = Vec3::Zero();
  Points points_;  // relative to the origin, so that no accuracy is lost far from it
};

VolumeBungeAssembly::VolumeBungeAssembly(const PolyhedralMesh& mesh,
                                         const DiscretizationOptions& options)
    : mesh_(mesh), options_(options), incidence_(volume_incidence(mesh_)) {
  check_cell_coefficient(options_, mesh_.n_cells());
  result_.name = "bunge";
  number_tets();
  loose_faces_ =
      std::any_of(incidence_.face_cells.begin(), incidence_.face_cells.end(),
                  [](const FaceCells& cells) { return cells.below < 0 && cells.above < 0; });
  tets_ = all_tetrahedra(incidence_) && !options_.coefficient;
  result_.stiffness = cell_pattern(incidence_, options_.threads);
  if (with_mass_) result_.mass = lumped_ ? diagonal_pattern(mesh_.n_vertices()) : result_.stiffness;
  if (with_mass_ || !tets_) result_.sample_measure.resize(n_tets());
  if (options_.parts >= DiscretizationParts::Gradient) make_gradient_pattern();
}

void VolumeBungeAssembly::number_tets() {
  const Csr& faces = mesh_.face_mesh().faces();
  first_tet_.resize(static_cast<std::size_t>(mesh_.n_cells()) + 1);
  std::int64_t total = 0;
  for (Index c = 0; c < mesh_.n_cells(); ++c) {
    first_tet_[c] = static_cast<Index>(total);
    for (const Index f : mesh_.cell(c)) total += faces.size(f);
    if (3 * total > std::numeric_limits<Index>::max())
      throw InvalidMesh("the gradient on the virtual tetrahedra of cells 0 to " +
                        std::to_string(c) +
                        " alone has more rows than 32 bits can number; split the mesh");
  }
  first_tet_[mesh_.n_cells()] = static_cast<Index>(total);
}

template <class Visit>
void VolumeBungeAssembly::for_tets(Index c, const Visit& visit) const {
  const Csr& faces = mesh_.face_mesh().faces();
  Index tet = first_tet_[c];
  for (const Index f : mesh_.cell(c)) {
    const bool above = mesh_.face_cells()[f].above == c;
    for (Index corner = faces.begin(f); corner < faces.end(f); ++corner) {
      const Index next = corner + 1 == faces.end(f) ? faces.begin(f) : corner + 1;
      visit(Place{tet++, c, f, corner, next, above});
    }
  }
}

Tetrahedron VolumeBungeAssembly::virtual_tet(const Place& at) const {
  const Vec3 xi = position(vertex(at.corner)), xj = position(vertex(at.next));
  const Vec3 xf = virtuals_.face_points.row(at.face).transpose();
  const Vec3 xc = virtuals_.cell_points.row(at.cell).transpose();
  Tetrahedron tet = at.above ? tetrahedron(xj, xi, xf, xc, 0) : tetrahedron(xi, xj, xf, xc, 0);
  if (at.above) std::swap(tet.normal[0], tet.normal[1]);
  return tet;
}

VirtualTetMatrix mass_of(double volume) {
  const double own = volume / 10, common = volume / 20;
  return {own, own, own, own, common, common, common, common, common, common};
}

/// Linear functions on a tetrahedron are linear on its virtual tetrahedra, twelfths of it.
/// \return false if some are so thin that one virtual tetrahedron may count where another does not
bool VolumeBungeAssembly::compute_tets() {
  std::atomic<bool> clear = true;
  const double safe = 24 * std::max(options_.eps_rel, kNoise);
  const Eigen::Index components = options_.cell_coefficient.cols();
  compute_linear_tets(
      points_, incidence_, options_.threads, linear_tets_, [&](Index c, LinearTet& tet) {
        if (!is_thicker(tet, safe)) {
          LinearTet turned = tet;
          turned.volume = -tet.volume;
          if (!is_thicker(turned, kNoise)) clear = false;
          tet = {};
        } else if (components == 6) {
          const double volume = tet.volume;  // the same bits with any K
          tet = linear_tet(cell_tetrahedron(points_, incidence_, c, 0), cell_tensor(options_, c));
          tet.volume = volume;
        } else if (components == 1) {
          for (double& pair : tet.pair) pair *= options_.cell_coefficient(c, 0);
        }
        if (with_mass_)
          result_.sample_measure.segment<12>(first_tet_[c]).setConstant(tet.volume / 12);
      });
  return clear;
}

/// Of one thread: a cell's vertices, and the corners of one of its faces.
struct VolumeBungeAssembly::Scratch {
  struct Corner {
    Vec3 x, cross;  // relative to the face point; times the tip
    double length2, to_tip2;
    Index place;  // in the cell
  };
  Array<Index> place;  // of vertices in the cell
  std::vector<Corner> corners;
};

void VolumeBungeAssembly::fill_cell(Index c, Scratch& scratch) {
  const Csr& faces = mesh_.face_mesh().faces();
  const Array<double>& weights = virtuals_.faces.weights;
  CellFormFiller stiffness(stiffness_, incidence_, weights, c);
  CellFormFiller mass(mass_, incidence_, weights, c);
  Index next_place = 0;
  for (const Index v : mesh_.cell_vertices().row(c)) scratch.place[v] = next_place++;
  const Vec3 xc = virtuals_.cell_points.row(c).transpose();
  const bool is_tensor = options_.cell_coefficient.cols() == 6;
  const Eigen::Matrix3d tensor = cell_tensor(options_, c);
  const double of_cell = is_tensor ? 1 : tensor(0, 0);
  const auto dot = [&](const Vec3& a, const Vec3& b) {
    return is_tensor ? a.dot(tensor * b) : a.dot(b);
  };
  const double limit2 = 36 * options_.eps_rel * options_.eps_rel;
  Index tet = first_tet_[c];
  for (const Index f : mesh_.cell(c)) {
    const Index first = faces.begin(f), size = faces.size(f);
    const bool above = mesh_.face_cells()[f].above == c;
    const Vec3 xf = virtuals_.face_points.row(f).transpose();
    const Vec3 tip = xc - xf;
    const double tip2 = tip.squaredNorm();
    if (scratch.corners.size() < static_cast<std::size_t>(size))
      scratch.corners.resize(static_cast<std::size_t>(size));
    for (Index k = 0; k < size; ++k) {
      const Index v = faces.indices[first + k];
      Scratch::Corner& corner = scratch.corners[k];
      corner.x = position(v) - xf;
      corner.cross = corner.x.cross(tip);
      corner.length2 = corner.x.squaredNorm();
      corner.to_tip2 = (corner.x - tip).squaredNorm();
      corner.place = scratch.place[v];
    }
    for (Index k = 0; k < size; ++k, ++tet) {
      const Index next = k + 1 == size ? 0 : k + 1;
      const Scratch::Corner &i = scratch.corners[k], &j = scratch.corners[next];
      // The normals of Tetrahedron: opposite to x_i is x_j x tip, to x_j -x_i x tip, to x_c this.
      const Vec3 normal = i.x.cross(j.x);
      const double det = above ? normal.dot(tip) : -normal.dot(tip);
      const double size2 =
          std::max({i.length2, j.length2, tip2, i.to_tip2, j.to_tip2, (i.x - j.x).squaredNorm()});
      const bool counts = det > 0 && det * det > limit2 * (size2 * size2 * size2);
      const double volume = counts ? det / 6 : 0.0;
      result_.sample_measure[tet] = volume;
      if (!counts) continue;
      double scale = of_cell / (6 * det);
      if (options_.coefficient)
        scale *= coefficient_at(options_, origin_ + xf + (i.x + j.x + tip) / 4);
      VirtualTetMatrix a;
      a.ii = scale * dot(j.cross, j.cross);
      a.jj = scale * dot(i.cross, i.cross);
      a.ij = -scale * dot(i.cross, j.cross);
      a.ci = scale * dot(j.cross, normal);
      a.cj = -scale * dot(i.cross, normal);
      a.cc = scale * dot(normal, normal);
      // Rows sum to zero.
      a.fi = -(a.ii + a.ij + a.ci);
      a.fj = -(a.jj + a.ij + a.cj);
      a.cf = -(a.ci + a.cj + a.cc);
      a.ff = -(a.fi + a.fj + a.cf);
      stiffness.add(f, first + k, first + next, i.place, j.place, a);
      if (lumped_)
        mass.add_lumped(f, i.place, j.place, volume / 4);
      else if (with_mass_)
        mass.add(f, first + k, first + next, i.place, j.place, mass_of(volume));
    }
    stiffness.end_face(f, [&](Index k) { return scratch.corners[k].place; });
    if (with_mass_ && !lumped_) mass.end_face(f, [&](Index k) { return scratch.corners[k].place; });
  }
}

void VolumeBungeAssembly::fill_forms() {
  stiffness_.reset(incidence_, false);
  if (with_mass_) mass_.reset(incidence_, lumped_);
  result_.sample_measure.resize(n_tets());
  // The caller's function is not asked to be thread-safe.
  const int threads = options_.coefficient ? 1 : options_.threads;
  parallel_blocks(mesh_.n_cells(), threads, [&](int, Index begin, Index end) {
    Scratch scratch;
    scratch.place.resize(static_cast<std::size_t>(mesh_.n_vertices()));
    for (Index c = begin; c < end; ++c) fill_cell(c, scratch);
  });
}

Index VolumeBungeAssembly::collect_columns(Index c, Index* columns) const {
  const std::span<const Index> vertices = mesh_.cell_vertices().row(c);
  std::sort(columns, std::copy(vertices.begin(), vertices.end(), columns));
  return static_cast<Index>(vertices.size());
}

void VolumeBungeAssembly::make_gradient_pattern() {
  result_.gradient_dimension = 3;
  Array<Index> row_sizes(3 * static_cast<std::size_t>(n_tets()));
  for (Index c = 0; c < mesh_.n_cells(); ++c)
    std::fill(row_sizes.begin() + 3 * std::ptrdiff_t{first_tet_[c]},
              row_sizes.begin() + 3 * std::ptrdiff_t{first_tet_[c + 1]},
              mesh_.cell_vertices().size(c));
  result_.gradient = allocate_rows(3 * n_tets(), mesh_.n_vertices(), row_sizes,
                                   "the gradient on virtual tetrahedra");
  Index* const inner = result_.gradient.innerIndexPtr();
  const Index* const outer = result_.gradient.outerIndexPtr();
  parallel_blocks(mesh_.n_cells(), options_.threads, [&](int, Index begin, Index end) {
    for (Index c = begin; c < end; ++c) {
      Index* const first = inner + outer[3 * first_tet_[c]];
      const Index n = collect_columns(c, first);
      for (Index* row = first + n; row < inner + outer[3 * first_tet_[c + 1]]; row += n)
        std::copy(first, first + n, row);
    }
  });
}

void VolumeBungeAssembly::assemble_gradient() {
  const Csr& faces = mesh_.face_mesh().faces();
  const Index* const outer = result_.gradient.outerIndexPtr();
  const Index* const inner = result_.gradient.innerIndexPtr();
  double* const values = result_.gradient.valuePtr();
  parallel_blocks(mesh_.n_cells(), options_.threads, [&](int, Index begin, Index end) {
    Array<Index> place(static_cast<std::size_t>(mesh_.n_vertices()));
    Vector of_face, of_cell;  // weights of the virtual vertices by the cell's columns
    for (Index c = begin; c < end; ++c) {
      const Index n = mesh_.cell_vertices().size(c);
      const Index* const columns = inner + outer[3 * first_tet_[c]];
      for (Index k = 0; k < n; ++k) place[columns[k]] = k;
      of_cell.setZero(n);
      for (Index k = mesh_.cell_vertices().begin(c); k < mesh_.cell_vertices().end(c); ++k)
        of_cell[place[mesh_.cell_vertices().indices[k]]] = virtuals_.cell_weights[k];
      for_tets(c, [&](const Place& at) {
        if (at.corner == faces.begin(at.face)) {
          of_face.setZero(n);
          for (Index k = at.corner; k < faces.end(at.face); ++k)
            of_face[place[vertex(k)]] += virtuals_.faces.weights[k];
        }
        double* const rows = values + outer[3 * at.tet];
        const Tetrahedron tet = virtual_tet(at);
        if (!(result_.sample_measure[at.tet] > 0 && tet.determinant > 0)) {
          std::fill(rows, rows + 3 * n, 0.0);
          return;
        }
        const Index i = place[vertex(at.corner)], j = place[vertex(at.next)];
        for (Index d = 0; d < 3; ++d) {
          const auto hat = [&](int a) { return tet.normal[a][d] / tet.determinant; };
          double* const row = rows + d * n;
          const double at_face = hat(2), at_cell = hat(3);
          for (Index k = 0; k < n; ++k) row[k] = at_face * of_face[k] + at_cell * of_cell[k];
          row[i] += hat(0);
          row[j] += hat(1);
        }
      });
    }
  });
}

void VolumeBungeAssembly::collect_frames() {
  result_.frames.parts.clear();
  result_.frames.parts.reserve(static_cast<std::size_t>(n_tets()));
  for (Index c = 0; c < mesh_.n_cells(); ++c)
    for_tets(c, [&](const Place& at) {
      const double volume = result_.sample_measure[at.tet];
      if (volume > 0)
        result_.frames.parts.push_back(
            {volume, at.tet, c, {vertex(at.corner), vertex(at.next), -1}});
    });
}

void VolumeBungeAssembly::report() {
  result_.diagnostics = {};
  report_unreferenced(mesh_, result_.diagnostics);
  report_virtual_cells(virtuals_, result_.diagnostics);
  std::vector<Index> excluded;
  if (closed_form_) {
    for (Index c = 0; c < mesh_.n_cells(); ++c)
      if (!(linear_tets_[c].volume > 0))
        for (Index tet = first_tet_[c]; tet < first_tet_[c + 1]; ++tet) excluded.push_back(tet);
  } else {
    for (Index tet = 0; tet < n_tets(); ++tet)
      if (!(result_.sample_measure[tet] > 0)) excluded.push_back(tet);
  }
  report_degenerate(
      std::move(excluded), options_, "virtual tet",
      [&](Index tet) {
        const auto end = std::upper_bound(first_tet_.begin(), first_tet_.end(), tet);
        std::string text;
        for_tets(static_cast<Index>(end - first_tet_.begin()) - 1, [&](const Place& at) {
          if (at.tet == tet)
            text = "cell " + std::to_string(at.cell) + ", face " + std::to_string(at.face) +
                   ", vertices " + std::to_string(vertex(at.corner)) + " and " +
                   std::to_string(vertex(at.next));
        });
        return text;
      },
      result_.diagnostics);
}

void VolumeBungeAssembly::reassemble(const Points& points) {
  centre_points(points, points_, origin_);
  closed_form_ = tets_ && compute_tets();
  const bool with_gradient = options_.parts >= DiscretizationParts::Gradient;
  if (!closed_form_ || with_gradient || loose_faces_) {
    update_virtual_cells(mesh_, points_, options_.virtual_vertex, options_.threads, virtuals_);
  } else {
    // Tetrahedra with a volume: there is nothing to report of their points.
    virtuals_.cell_status.clear();
    virtuals_.faces.status.clear();
  }
  SparseMatrix* const mass = with_mass_ ? &result_.mass : nullptr;
  if (closed_form_) {
    assemble_linear_tets(result_.stiffness, mass, lumped_, incidence_, linear_tets_,
                         options_.threads);
  } else {
    fill_forms();
    const auto assemble = [&](SparseMatrix& matrix, bool lumped, const CellForm& form) {
      assemble_cell_form(matrix, lumped, incidence_, mesh_.face_mesh().vertex_corners(),
                         mesh_.face_mesh().corner_faces(), virtuals_.faces.weights,
                         virtuals_.cell_weights, form, options_.threads);
    };
    assemble(result_.stiffness, false, stiffness_);
    if (mass != nullptr) assemble(*mass, lumped_, mass_);
  }
  if (with_gradient) assemble_gradient();
  if (options_.parts == DiscretizationParts::Frames) collect_frames();
  report();
}

}  // namespace

extern const VolumeOperator bunge_volume_operator = {
    "bunge",
    "Polygon Laplacian: linear elements on virtual tetrahedra",
    "Bunge, Herholz, Kazhdan, Botsch: Polygon Laplacian Made Simple, 2020",
    {.equals_cotan_on_simplices = true, .face_local = true},
    {.masses = {MassKind::Lumped, MassKind::Full}, .virtual_vertex = true, .stiffness_alone = true},
    {"S = P^T S_tet P: linear elements on the tetrahedra of every edge, its face's and its cell's "
     "virtual vertex. Mass P^T M_tet P, by default its row sums.",
     "vertices", "vertices of common cells",
     "Where sparsity counts more than accuracy: half of the diamond's entries and less.",
     "Bunge, Herholz, Kazhdan, Botsch: Polygon Laplacian Made Simple, 2020"},
    [](const PolyhedralMesh& mesh,
       const DiscretizationOptions& options) -> std::unique_ptr<Assembly> {
      return std::make_unique<VolumeBungeAssembly>(mesh, options);
    }};

}  // namespace carat
