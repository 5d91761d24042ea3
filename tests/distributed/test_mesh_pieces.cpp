#include "carat/base/error.h"
#include "carat/distributed/exchange.h"
#include "carat/distributed/mesh_pieces.h"
#include "carat/operators/part_discretization.h"
#include "pieces.h"

namespace carat::test {
namespace {

TEST(MeshPieces, surfaces_with_ids_are_joined_to_the_parts_of_the_whole) {
  for (const auto& [name, mesh] : surfaces_to_divide()) {
    SCOPED_TRACE(name);
    for_cuts(mesh, [&, &mesh = mesh](const std::vector<Index>& cut) {
      expect_same(join_pieces(piece_of(mesh, cut)), expected_part(mesh, cut));
    });
  }
}

TEST(MeshPieces, volumes_with_ids_are_joined_to_the_parts_of_the_whole) {
  for (const auto& [name, mesh] : volumes_to_divide()) {
    SCOPED_TRACE(name);
    for_cuts(mesh, [&, &mesh = mesh](const std::vector<Index>& cut) {
      expect_same(join_pieces(piece_of(mesh, cut)), expected_part(mesh, cut));
    });
  }
}

TEST(MeshPieces, faces_without_ids_are_numbered_as_the_cells_name_them) {
  for (const auto& [name, given] : volumes_to_divide()) {
    SCOPED_TRACE(name);
    const PolyhedralMesh mesh = numbered_by_cells(given);
    for_cuts(mesh, [&](const std::vector<Index>& cut) {
      MeshPiece<PolyhedralMesh> piece = piece_of(mesh, cut);
      piece.interface_ids.clear();
      expect_same(join_pieces(std::move(piece)), expected_part(mesh, cut));
    });
  }
}

template <class Mesh>
void check_many_interfaces(const Mesh& mesh, bool have_ids) {
  for_cuts(mesh, [&](const std::vector<Index>& cut) {
    MeshPiece<Mesh> piece = piece_of(mesh, cut);
    if (!have_ids) piece.interface_ids.clear();
    PartData<Mesh> expected = expected_part(mesh, cut);
    expected.part = with_first_interface(std::move(expected.part), kManyInterfaces);
    const PartData<Mesh> data = join_pieces(std::move(piece), kManyInterfaces);
    expect_same(data, expected);
    for (const std::int64_t number : data.part.numbers.interfaces)
      EXPECT_GE(number, kManyInterfaces);
  });
}

TEST(MeshPieces, interfaces_are_numbered_beyond_32_bits) {
  for (const auto& [name, mesh] : surfaces_to_divide()) {
    SCOPED_TRACE(name);
    check_many_interfaces(mesh, false);
  }
  for (const auto& [name, mesh] : volumes_to_divide()) {
    SCOPED_TRACE(name);
    check_many_interfaces(mesh, true);
    check_many_interfaces(numbered_by_cells(mesh), false);
  }
}

bool has_equal_points(const Points& points) {
  std::vector<std::array<double, 3>> places;
  for (Index v = 0; v < points.rows(); ++v)
    places.push_back({points(v, 0), points(v, 1), points(v, 2)});
  std::sort(places.begin(), places.end());
  return std::adjacent_find(places.begin(), places.end()) != places.end();
}

/// A value that tells places apart.
double sample(const Points& points, Index v) {
  return std::sin(3 * points(v, 0)) + std::cos(5 * points(v, 1)) + std::sin(7 * points(v, 2));
}

/// The product of the stiffness with the sample at every place.
using Products = std::map<std::array<double, 3>, double>;

void add(Products& products, const Points& points, const Vector& values) {
  for (Index v = 0; v < values.size(); ++v)
    products[{points(v, 0), points(v, 1), points(v, 2)}] += values[v];
}

Vector times_sample(const SparseMatrix& matrix, const Points& points) {
  Vector u(points.rows());
  for (Index v = 0; v < u.size(); ++v) u[v] = sample(points, v);
  return matrix * u;
}

template <class Mesh>
void check_sum_without_ids(const Mesh& mesh, const std::vector<Index>& cut) {
  MeshPiece<Mesh> piece = piece_of(mesh, cut);
  piece.vertex_ids.clear();
  piece.element_ids.clear();
  piece.interface_ids.clear();
  const PartData<Mesh> data = join_pieces(std::move(piece));
  const PartNumbers& numbers = data.part.numbers;
  EXPECT_EQ(numbers.n_vertices, mesh.n_vertices());
  EXPECT_EQ(numbers.n_components, divide(mesh, n_processes(), cut).n_components);
  EXPECT_EQ(sum_of_all(std::int64_t{numbers.end_row} - numbers.first_row), mesh.n_vertices());
  EXPECT_EQ(sum_of_all(std::int64_t(
                std::count(numbers.own_elements.begin(), numbers.own_elements.end(), true))),
            n_elements(mesh));
  const Discretization own = discretize_part(data.part, "diamond", {});
  // By numbers in the whole mesh, then by places.
  std::vector<double> sums(std::size_t(numbers.n_vertices)), places(3 * sums.size());
  const Vector here = times_sample(own.stiffness, data.part.mesh.points());
  for (Index v = 0; v < here.size(); ++v) {
    const auto number = std::size_t(numbers.vertices[v]);
    sums[number] += here[v];
    for (std::size_t k = 0; k < 3 && numbers.own_vertex(v); ++k)
      places[3 * number + k] = data.part.mesh.points()(v, Index(k));
  }
  sums = sum_of_all(sums);
  places = sum_of_all(places);
  Products joined, expected;
  add(joined, Eigen::Map<const Points>(places.data(), Eigen::Index(sums.size()), 3),
      Eigen::Map<const Vector>(sums.data(), Eigen::Index(sums.size())));
  const Discretization whole = discretize(mesh, "diamond", {});
  const Vector of_whole = times_sample(whole.stiffness, mesh.points());
  add(expected, mesh.points(), of_whole);
  const double scale = whole.stiffness.coeffs().abs().maxCoeff();
  ASSERT_EQ(joined.size(), expected.size());
  for (const auto& [place, value] : expected) {
    ASSERT_TRUE(joined.contains(place));
    // Sums of a row, in another order.
    EXPECT_NEAR(joined[place], value, 1e-12 * scale);
  }
}

TEST(MeshPieces, matrices_of_pieces_without_ids_add_up_to_the_whole) {
  int checked = 0;
  for (const auto& [name, mesh] : surfaces_to_divide()) {
    SCOPED_TRACE(name);
    if (has_equal_points(mesh.points())) continue;
    ++checked;
    for_cuts(mesh, [&, &mesh = mesh](const auto& cut) { check_sum_without_ids(mesh, cut); });
  }
  for (const auto& [name, mesh] : volumes_to_divide()) {
    SCOPED_TRACE(name);
    if (has_equal_points(mesh.points())) continue;
    ++checked;
    for_cuts(mesh, [&, &mesh = mesh](const auto& cut) { check_sum_without_ids(mesh, cut); });
  }
  EXPECT_GT(checked, 30);
}

/// The message that all processes get; they must get the same.
template <class Mesh, class Kind = InvalidMesh>
std::string failure(MeshPiece<Mesh> piece) {
  try {
    join_pieces(std::move(piece));
  } catch (const Shared<Kind>& error) {
    std::size_t sum = 0;
    for (const char c : std::string_view(error.what())) sum = sum * 31 + std::size_t(c);
    const auto same = double(sum % 1000003);
    EXPECT_EQ(largest_of_all(same), same);
    return error.what();
  }
  return "nothing is thrown";
}

TEST(MeshPieces, what_does_not_fit_is_refused_by_all) {
  if (n_processes() < 2) return;
  const PolygonMesh mesh = generate_mesh("plane-quads", {.level = 1});
  const PolyhedralMesh volume = hex_grid(3);
  const std::vector<Index> cut = in_blocks(mesh.n_faces(), n_processes()),
                           cut_volume = in_blocks(volume.n_cells(), n_processes());
  const bool last = rank() + 1 == n_processes();
  const auto expect = [&](const std::string& message, const std::string& says) {
    EXPECT_NE(message.find(says), std::string::npos) << message;
  };
  MeshPiece<PolygonMesh> piece = piece_of(mesh, cut);
  if (last) piece.vertex_ids.clear();
  expect(failure(piece), "its piece has no global ids of vertices");
  piece = piece_of(mesh, cut);
  if (last) piece.element_ids.pop_back();
  expect(failure(piece), "global ids for");
  piece = piece_of(mesh, cut);
  if (last) piece.element_ids[0] = ids_of({0})[0];
  expect(failure(piece), "is given to several elements");
  piece = piece_of(mesh, cut);
  if (last) piece.vertex_ids[0] = piece.vertex_ids[1];
  expect(failure(piece), "two vertices with the same global id");
  piece = piece_of(mesh, cut);
  if (last) piece.mesh = piece.mesh.with_points(piece.mesh.points() * 1.001);
  expect(failure(piece), "lies elsewhere");
  piece = piece_of(mesh, cut);
  if (last) piece.fields.vertex[1].name = "speed";
  expect(failure<PolygonMesh, IoError>(piece), "no vertex field 'velocity'");
  piece = piece_of(mesh, cut);
  if (last) piece.fields.face.push_back({"more", 1, std::vector<double>(piece.element_ids.size())});
  expect(failure<PolygonMesh, IoError>(piece), "field 'more'");

  MeshPiece<PolyhedralMesh> cells = piece_of(volume, cut_volume);
  if (last) {
    Array<FaceCells> swapped = cells.mesh.face_cells();
    for (FaceCells& sides : swapped) std::swap(sides.below, sides.above);
    cells.mesh = PolyhedralMesh::from_face_cells(
        cells.mesh.points(), cells.mesh.face_mesh().faces(), cells.mesh.cells(), swapped);
  }
  expect(failure(cells), "same side of their face");
  cells = piece_of(volume, cut_volume);
  if (last) cells.interface_ids.assign(cells.interface_ids.size(), 7);
  expect(failure(cells), "belongs to");
  // All pieces hold the same cells.
  cells = piece_of(volume, std::vector<Index>(std::size_t(volume.n_cells()), rank()));
  expect(failure(cells), "is given to several elements");
  for (std::vector<std::int64_t>* ids :
       {&cells.vertex_ids, &cells.element_ids, &cells.interface_ids})
    ids->clear();
  if (n_processes() > 2) expect(failure(cells), "a face belongs to");
}

TEST(MeshPieces, a_slit_along_the_cut_needs_ids) {
  if (n_processes() != 2) return;
  // Process 0 has two triangles that meet the other's at one place, but not each other.
  Points points(6, 3);
  points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, -1, 0;
  MeshPiece<PolygonMesh> piece;
  if (rank() == 0) {
    piece.mesh = PolygonMesh::from_faces(points, {{0, 1, 2}, {3, 4, 5}});
  } else {
    Points other(3, 3);
    other << -0.0, 0, 0, 0, 0, 1, 1, 0, 0;
    piece.mesh = PolygonMesh::from_faces(other, {{0, 1, 2}});
  }
  EXPECT_NE(failure(piece).find("give the pieces global vertex ids"), std::string::npos);
  piece.vertex_ids = rank() == 0 ? std::vector<std::int64_t>{0, 1, 2, 3, 4, 5}
                                 : std::vector<std::int64_t>{3, 6, 1};
  const PartData<PolygonMesh> data = join_pieces(piece);
  EXPECT_EQ(data.part.numbers.n_vertices, 7);
  EXPECT_EQ(data.part.numbers.n_components, 1);
}

TEST(MeshPieces, more_than_can_be_numbered_is_refused) {
  check_count((std::int64_t{1} << 31) - 1, "vertices");
  try {
    check_count(std::int64_t{1} << 31, "vertices");
    FAIL();
  } catch (const Shared<InvalidMesh>& error) {
    EXPECT_NE(std::string(error.what()).find("2147483648 vertices"), std::string::npos);
  }
}

TEST(MeshPieces, lists_go_in_rounds_of_any_size) {
  const int n = n_processes();
  for (const std::size_t most : {1, 7, 100, 1000000}) {
    std::vector<std::vector<char>> lists;
    std::vector<std::span<const char>> to;
    const auto value = [](int from, int process, int k) {
      return static_cast<char>((17 * from + 5 * process + k) % 127);
    };
    for (int p = 0; p < n; ++p) {
      std::vector<char> list;
      for (int k = 0; k < 40 * ((rank() + 2 * p) % 3); ++k) list.push_back(value(rank(), p, k));
      lists.push_back(list);
    }
    for (const std::vector<char>& list : lists) to.emplace_back(list);
    const auto from = exchange_bytes(to, most);
    for (int p = 0; p < n; ++p) {
      ASSERT_EQ(from[std::size_t(p)].size(), std::size_t(40 * ((p + 2 * rank()) % 3)));
      for (int k = 0; k < int(from[std::size_t(p)].size()); ++k)
        EXPECT_EQ(from[std::size_t(p)][std::size_t(k)], value(p, rank(), k));
    }
  }
}

}  // namespace
}  // namespace carat::test
