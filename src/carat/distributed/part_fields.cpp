#include "carat/distributed/part_fields.h"

#include <algorithm>

#include "carat/distributed/processes.h"

namespace carat {

Array<Index> discretized_elements(const PartNumbers& numbers,
                                  const Discretization& discretization) {
  if (!discretization.options.own_interfaces.empty()) return numbers.elements;
  Array<Index> own;
  for (std::size_t e = 0; e < numbers.elements.size(); ++e)
    if (numbers.own_elements[e]) own.push_back(numbers.elements[e]);
  return own;
}

PartFields::PartFields(const PartNumbers& numbers, const Discretization& discretization)
    : numbers_(numbers),
      discretization_(discretization),
      element_ids_(discretized_elements(numbers, discretization)),
      vertices_(numbers.vertices),
      elements_(element_ids_) {}

Points PartFields::vertex_vectors(const Vector& vectors) const {
  VectorSums sums;
  together([&] { sums = discretization_.vertex_sums(vectors); });
  return means_of_sums(vertices_.sum(sums));
}

VectorSums PartFields::element_sums(const Vector& vectors) const {
  VectorSums sums;
  together([&] {
    sums = discretization_.element_sums(vectors, static_cast<Index>(element_ids_.size()));
  });
  return elements_.sum(sums);
}

Points PartFields::element_vectors(const Vector& vectors) const {
  const Points means = means_of_sums(element_sums(vectors));
  if (element_ids_.size() == numbers_.elements.size()) return means;
  Points all = Points::Zero(static_cast<Index>(numbers_.elements.size()), 3);
  Index own = 0;
  for (Index e = 0; e < all.rows(); ++e)
    if (numbers_.own_elements[static_cast<std::size_t>(e)]) all.row(e) = means.row(own++);
  return all;
}

Vector PartFields::element_directions(const Vector& vectors) const {
  together([&] {
    if (const std::string reason = discretization_.lacks_element_directions(); !reason.empty())
      throw InvalidOption("the operator " + discretization_.name +
                          " gives no directions of elements: " + reason);
  });
  // Scaled first: the squares of small values would vanish in the means' lengths.
  const double scale = largest_of_all(vectors.size() > 0 ? vectors.lpNorm<Eigen::Infinity>() : 0.0);
  return discretization_.directions_of_field(
      directions_of_sums(element_sums(scale > 0 ? Vector(vectors / scale) : vectors)));
}

namespace {

/// \param counts  which edges of the part count here
template <class Counts>
EdgeLengths sum_lengths(const PolygonMesh& mesh, const Counts& counts) {
  EdgeLengths edges;
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    if (!counts(e)) continue;
    const auto& [a, b] = mesh.edges().vertices[static_cast<std::size_t>(e)];
    const double length = (mesh.point(b) - mesh.point(a)).norm();
    ++edges.count;
    edges.sum += length;
    edges.longest = std::max(edges.longest, length);
  }
  edges.count = sum_of_all(edges.count);
  edges.sum = sum_of_all(edges.sum);
  edges.longest = largest_of_all(edges.longest);
  return edges;
}

}  // namespace

EdgeLengths edge_lengths(const MeshPart<PolygonMesh>& part) {
  return sum_lengths(part.mesh, [&](Index e) { return part.numbers.own_interfaces[e]; });
}

EdgeLengths edge_lengths(const MeshPart<PolyhedralMesh>& part) {
  const PartNumbers& numbers = part.numbers;
  const PolygonMesh& faces = part.mesh.face_mesh();
  const EdgeTopology& edges = faces.edges();
  std::vector<bool> counts(static_cast<std::size_t>(faces.n_edges()), false);
  Matrix has_own = Matrix::Zero(part.mesh.n_vertices(), 1);
  for (Index c = 0; c < part.mesh.n_cells(); ++c) {
    if (!numbers.own_elements[static_cast<std::size_t>(c)]) continue;
    for (const Index v : part.mesh.cell_vertices().row(c)) has_own(v, 0) = 1;
    for (const Index f : part.mesh.cell(c))
      for (Index corner = faces.faces().begin(f); corner < faces.faces().end(f); ++corner)
        counts[static_cast<std::size_t>(edges.of_corner[corner])] = true;
  }
  // Edges between vertices with own cells of several parts may be those of several parts.
  const Matrix n_parts = NumberExchange(numbers.vertices).sum(has_own);
  std::vector<Index> shared;
  std::vector<std::int64_t> numbers_of_shared;
  for (Index e = 0; e < faces.n_edges(); ++e) {
    const auto& [a, b] = edges.vertices[static_cast<std::size_t>(e)];
    if (!counts[static_cast<std::size_t>(e)] || n_parts(a, 0) < 2 || n_parts(b, 0) < 2) continue;
    shared.push_back(e);
    numbers_of_shared.push_back(std::int64_t{numbers.vertices[a]} * numbers.n_vertices +
                                numbers.vertices[b]);
  }
  const NumberExchange exchange(std::move(numbers_of_shared));
  const std::vector<std::int64_t> lowest =
      exchange.least(std::vector<std::int64_t>(shared.size(), own_rank()));
  for (std::size_t k = 0; k < shared.size(); ++k)
    if (lowest[k] != own_rank()) counts[static_cast<std::size_t>(shared[k])] = false;
  return sum_lengths(faces, [&](Index e) { return counts[static_cast<std::size_t>(e)]; });
}

}  // namespace carat
