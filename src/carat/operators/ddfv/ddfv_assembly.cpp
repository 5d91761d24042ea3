#include "carat/operators/ddfv/ddfv_assembly.h"

#include <algorithm>
#include <limits>
#include <string>

#include "carat/assembly/row_assembly.h"
#include "carat/assembly/row_pattern.h"
#include "carat/base/error.h"
#include "carat/base/parallel.h"
#include "carat/operators/common.h"

namespace carat {

void DdfvAssembly::build(Index n_samples, const Numbering& numbering) {
  check_cell_coefficient(options_, mesh_.n_cells());
  number_unknowns(numbering);
  find_columns(n_samples);
  make_patterns();
  diamonds_.resize(static_cast<std::size_t>(n_samples));
  values_.resize(3 * columns_.indices.size());
  result_.sample_measure.resize(n_samples);
}

std::vector<bool> DdfvAssembly::boundary_edges() const {
  std::vector<bool> flags(static_cast<std::size_t>(mesh_.n_edges()), false);
  const PolygonMesh& faces = mesh_.face_mesh();
  for (Index f = 0; f < mesh_.n_faces(); ++f)
    if (mesh_.face_cells()[f].boundary())
      for (Index c = faces.faces().begin(f); c < faces.faces().end(f); ++c)
        flags[static_cast<std::size_t>(faces.edges().of_corner[c])] = true;
  return flags;
}

void DdfvAssembly::number_unknowns(const Numbering& numbering) {
  ExtraUnknowns& extra = result_.extra;
  face_unknown_.assign(static_cast<std::size_t>(mesh_.n_faces()), -1);
  edge_unknown_.assign(static_cast<std::size_t>(mesh_.n_edges()), -1);
  n_unknowns_ = mesh_.n_vertices();
  const std::int64_t all =
      std::int64_t{mesh_.n_vertices()} + mesh_.n_faces() + mesh_.n_cells() + mesh_.n_edges();
  if (all > std::numeric_limits<Index>::max())
    throw InvalidMesh("values at vertices, faces, cells and edges are " + std::to_string(all) +
                      ", more than 32 bits can number; split the mesh");
  const std::vector<bool> boundary_edge = boundary_edges();
  extra.boundary_vertices = {};
  const auto add = [&](Index element, std::vector<Index>& list, bool on_boundary,
                       std::span<const Index> vertices) {
    list.push_back(element);
    Csr& of = extra.boundary_vertices;
    if (on_boundary) of.indices.insert(of.indices.end(), vertices.begin(), vertices.end());
    of.offsets.push_back(static_cast<Index>(of.indices.size()));
    return n_unknowns_++;
  };
  for (const Site site : numbering.order) {
    std::vector<Index> list;
    if (site == Site::Face) {
      for (Index f = 0; f < mesh_.n_faces(); ++f)
        if (numbering.face[static_cast<std::size_t>(f)])
          face_unknown_[static_cast<std::size_t>(f)] =
              add(f, list, mesh_.face_cells()[f].boundary(), mesh_.face(f));
      extra.blocks.push_back({ExtraUnknowns::Site::Face, std::move(list)});
    } else if (site == Site::Cell) {
      first_cell_ = n_unknowns_;
      for (Index c = 0; c < mesh_.n_cells(); ++c) add(c, list, false, {});
      extra.blocks.push_back({ExtraUnknowns::Site::Cell, std::move(list)});
    } else {
      for (Index e = 0; e < mesh_.n_edges(); ++e)
        if (numbering.edge[static_cast<std::size_t>(e)])
          edge_unknown_[static_cast<std::size_t>(e)] =
              add(e, list, boundary_edge[static_cast<std::size_t>(e)], edge(e));
      extra.blocks.push_back({ExtraUnknowns::Site::Edge, std::move(list)});
    }
  }
  extra.positions.setZero(n_unknowns_ - mesh_.n_vertices(), 3);
}

template <class Visit>
void DdfvAssembly::for_unknowns(Site site, Index id, const Visit& visit) const {
  const auto mean_of = [&](std::span<const Index> vertices) {
    for (const Index v : vertices) visit(v, 1.0 / static_cast<double>(vertices.size()));
  };
  switch (site) {
    case Site::Vertex:
      return visit(id, 1.0);
    case Site::Cell:
      return visit(first_cell_ + id, 1.0);
    case Site::Face:
      if (const Index unknown = face_unknown_[static_cast<std::size_t>(id)]; unknown >= 0)
        return visit(unknown, 1.0);
      return mean_of(mesh_.face(id));
    default:
      if (const Index unknown = edge_unknown_[static_cast<std::size_t>(id)]; unknown >= 0)
        return visit(unknown, 1.0);
      return mean_of(edge(id));
  }
}

void DdfvAssembly::add_weight(Vector& weights, Site site, Index id, double weight) const {
  for_unknowns(site, id, [&](Index unknown, double part) { weights[unknown] += part * weight; });
}

void DdfvAssembly::find_columns(Index n_samples) {
  std::vector<Term> terms;
  Array<Index> columns;
  Array<Index> counts(static_cast<std::size_t>(n_unknowns_) + 1, 0);
  for (Index s = 0; s < n_samples; ++s) {
    terms.clear();
    columns.clear();
    collect_terms(s, terms);
    for (const Term& term : terms)
      for_unknowns(term.site, term.id, [&](Index unknown, double) { columns.push_back(unknown); });
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    if (columns_.indices.size() + columns.size() > std::numeric_limits<Index>::max() / 3)
      throw InvalidMesh("the gradient on diamonds has 2^31 entries or more; split the mesh");
    for (const Index unknown : columns) ++counts[static_cast<std::size_t>(unknown) + 1];
    columns_.indices.insert(columns_.indices.end(), columns.begin(), columns.end());
    columns_.offsets.push_back(static_cast<Index>(columns_.indices.size()));
  }
  for (Index i = 0; i < n_unknowns_; ++i) counts[i + 1] += counts[i];
  unknown_samples_.offsets = counts;
  unknown_samples_.indices.resize(columns_.indices.size());
  for (Index s = 0; s < n_samples; ++s)
    for (const Index unknown : columns_.row(s)) unknown_samples_.indices[counts[unknown]++] = s;
}

void DdfvAssembly::make_patterns() {
  Array<Index> sizes, same;
  const std::vector<CollectedRows> rows =
      collect_rows(n_unknowns_, options_.threads, sizes, same, [&](Index row, RowCollector& out) {
        for (const Index s : unknown_samples_.row(row))
          for (const Index column : columns_.row(s)) out.add(column, row);
        return Index{0};
      });
  result_.stiffness = allocate_rows(n_unknowns_, n_unknowns_, sizes, "the matrix");
  write_transposed(rows, sizes, sizes, options_.threads, result_.stiffness);
  result_.mass = diagonal_pattern(n_unknowns_);
  if (options_.parts == DiscretizationParts::Matrices) return;
  const Index n_samples = columns_.n_rows();
  if (std::int64_t{n_samples} * 3 > std::numeric_limits<Index>::max())
    throw InvalidMesh("the gradient of " + std::to_string(n_samples) +
                      " diamonds has more rows than 32 bits can number; split the mesh");
  Array<Index> row_sizes(3 * static_cast<std::size_t>(n_samples));
  for (Index s = 0; s < n_samples; ++s)
    for (Index k = 0; k < 3; ++k) row_sizes[3 * s + k] = columns_.size(s);
  result_.gradient_dimension = 3;
  result_.gradient =
      allocate_rows(3 * n_samples, n_unknowns_, row_sizes, "the gradient on diamonds");
  for (Index s = 0; s < n_samples; ++s)
    for (Index k = 0; k < 3; ++k)
      std::copy(columns_.row(s).begin(), columns_.row(s).end(),
                result_.gradient.innerIndexPtr() + result_.gradient.outerIndexPtr()[3 * s + k]);
}

void DdfvAssembly::compute_points(const Points& points) {
  centre_points(points, points_, origin_);
  face_points_.resize(mesh_.n_faces(), 3);
  cell_points_.resize(mesh_.n_cells(), 3);
  const auto mean = [&](std::span<const Index> vertices) -> Eigen::RowVector3d {
    // From the first one, so that small elements far away keep their digits.
    const Eigen::RowVector3d first = points_.row(vertices[0]);
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (const Index v : vertices) sum += points_.row(v) - first;
    return first + sum / static_cast<double>(vertices.size());
  };
  for (Index f = 0; f < mesh_.n_faces(); ++f) face_points_.row(f) = mean(mesh_.face(f));
  for (Index c = 0; c < mesh_.n_cells(); ++c)
    cell_points_.row(c) = mean(mesh_.cell_vertices().row(c));
  Index k = 0;
  for (const ExtraUnknowns::Block& block : result_.extra.blocks)
    for (const Index id : block.elements) {
      auto x = result_.extra.positions.row(k++);
      if (block.site == ExtraUnknowns::Site::Face)
        x = face_points_.row(id);
      else if (block.site == ExtraUnknowns::Site::Cell)
        x = cell_points_.row(id);
      else
        x = (points_.row(edge(id)[0]) + points_.row(edge(id)[1])) / 2;
      x += origin_.transpose();
    }
}

void DdfvAssembly::compute_gradients() {
  parallel_blocks(columns_.n_rows(), options_.threads, [&](int, Index begin, Index end) {
    std::vector<Term> terms;
    for (Index s = begin; s < end; ++s) {
      terms.clear();
      collect_terms(s, terms);
      double* const values = values_.data() + 3 * std::size_t(columns_.begin(s));
      std::fill(values, values + 3 * columns_.size(s), 0.0);
      Diamond d{0, Vec3::Zero(), {0, 0}, -1};
      if (!terms.empty()) d = diamond(s, terms.data());
      if (!(d.volume > 0)) d.volume = 0;
      diamonds_[s] = d;
      result_.sample_measure[s] = d.volume;
      if (!(d.volume > 0)) continue;
      const std::span<const Index> columns = columns_.row(s);
      for (const Term& term : terms)
        for_unknowns(term.site, term.id, [&](Index unknown, double part) {
          const auto place = std::lower_bound(columns.begin(), columns.end(), unknown);
          double* const g = values + 3 * (place - columns.begin());
          for (int k = 0; k < 3; ++k) g[k] += part * term.g[k];
        });
    }
  });
}

Eigen::Matrix3d DdfvAssembly::conductivity(Index sample) const {
  const Diamond& d = diamonds_[sample];
  const FaceCells cells = mesh_.face_cells()[d.face];
  const double below = std::max(0.0, d.parts[0]), above = std::max(0.0, d.parts[1]);
  const double all = below + above;
  Eigen::Matrix3d k = Eigen::Matrix3d::Zero();
  if (cells.below >= 0) k += (all > 0 ? below / all : 1.0) * cell_tensor(options_, cells.below);
  if (cells.above >= 0 && (all > 0 || cells.below < 0))
    k += (all > 0 ? above / all : 1.0) * cell_tensor(options_, cells.above);
  if (options_.coefficient) k *= coefficient_at(options_, origin_ + d.centroid);
  return k;
}

void DdfvAssembly::assemble_stiffness() {
  const bool plain = !options_.coefficient && options_.cell_coefficient.size() == 0;
  Array<Eigen::Matrix3d> tensors;
  if (!plain) {
    tensors.resize(diamonds_.size());
    for (Index s = 0; s < columns_.n_rows(); ++s)
      tensors[s] =
          diamonds_[s].volume > 0 ? conductivity(s) : Eigen::Matrix3d(Eigen::Matrix3d::Zero());
  }
  parallel_blocks(n_unknowns_, options_.threads, [&](int, Index first, Index last) {
    Array<Index> position(static_cast<std::size_t>(n_unknowns_));
    for (Index row = first; row < last; ++row) {
      const RowWriter writer(result_.stiffness, row, position);
      for (const Index s : unknown_samples_.row(row)) {
        if (!(diamonds_[s].volume > 0)) continue;
        const std::span<const Index> columns = columns_.row(s);
        const auto g = [&](std::ptrdiff_t k) {
          return Eigen::Map<const Vec3>(values_.data() + 3 * (columns_.begin(s) + k));
        };
        const auto own = std::lower_bound(columns.begin(), columns.end(), row) - columns.begin();
        Vec3 flux = diamonds_[s].volume * g(own);
        if (!plain) flux = tensors[s] * flux;
        for (std::size_t k = 0; k < columns.size(); ++k)
          writer.add(columns[k], flux.dot(g(static_cast<std::ptrdiff_t>(k))));
      }
    }
  });
}

void DdfvAssembly::reassemble(const Points& points) {
  compute_points(points);
  compute_gradients();
  assemble_stiffness();
  Vector weights = Vector::Zero(n_unknowns_);
  add_weights(weights);
  std::copy(weights.begin(), weights.end(), result_.mass.valuePtr());
  if (options_.parts != DiscretizationParts::Matrices)
    for (Index s = 0; s < columns_.n_rows(); ++s)
      for (Index j = 0; j < columns_.size(s); ++j)
        for (Index k = 0; k < 3; ++k)
          result_.gradient.valuePtr()[result_.gradient.outerIndexPtr()[3 * s + k] + j] =
              values_[3 * std::size_t(columns_.begin(s) + j) + std::size_t(k)];
  if (options_.parts == DiscretizationParts::Frames) collect_frames();
  report();
}

void DdfvAssembly::collect_frames() {
  result_.frames.parts.clear();
  for (Index s = 0; s < columns_.n_rows(); ++s) {
    if (!(diamonds_[s].volume > 0)) continue;
    const FaceCells cells = mesh_.face_cells()[diamonds_[s].face];
    const std::vector<Index> vertices = vertices_of(s);
    for (const int side : {0, 1}) {
      const Index cell = side == 0 ? cells.below : cells.above;
      const double part = diamonds_[s].parts[static_cast<std::size_t>(side)];
      if (cell < 0 || !(part > 0)) continue;
      for (const Index v : vertices)
        result_.frames.parts.push_back(
            {part / static_cast<double>(vertices.size()), s, cell, {v, -1, -1}});
    }
  }
}

void DdfvAssembly::report() {
  result_.diagnostics = {};
  report_unreferenced(mesh_, result_.diagnostics);
  std::vector<Index> excluded;
  for (Index s = 0; s < columns_.n_rows(); ++s)
    if (diamonds_[s].face >= 0 && !(diamonds_[s].volume > 0)) excluded.push_back(s);
  report_degenerate(
      std::move(excluded), options_, "diamond", [&](Index s) { return describe(s); },
      result_.diagnostics);
}

}  // namespace carat
