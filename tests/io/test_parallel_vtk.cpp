#include "carat/base/error.h"
#include "carat/io/parallel_vtk.h"
#include "piece_files.h"
#include "volume_samples.h"

namespace carat::test {
namespace {

TEST(ParallelVtk, the_index_names_pieces_and_fields) {
  const TemporaryFolder folder;
  write_parallel_index(folder / "u.pvtu", {"u_0.vtu", "a&b \"c\".vtu"},
                       {{"u", 1}, {"grad<u>", 3}, {"grad_u_", 3}}, {{kGhostField, 1}}, 1);
  EXPECT_EQ(read_bytes(folder / "u.pvtu"),
            R"(<?xml version="1.0"?>
<VTKFile type="PUnstructuredGrid" version="0.1" byte_order="LittleEndian">
  <PUnstructuredGrid GhostLevel="1">
    <PPointData>
      <PDataArray type="Float64" Name="u" NumberOfComponents="1"/>
      <PDataArray type="Float64" Name="grad_u_" NumberOfComponents="3"/>
      <PDataArray type="Float64" Name="grad_u__" NumberOfComponents="3"/>
    </PPointData>
    <PCellData>
      <PDataArray type="UInt8" Name="vtkGhostType" NumberOfComponents="1"/>
    </PCellData>
    <PPoints>
      <PDataArray type="Float64" Name="Points" NumberOfComponents="3"/>
    </PPoints>
    <Piece Source="u_0.vtu"/>
    <Piece Source="a&amp;b &quot;c&quot;.vtu"/>
  </PUnstructuredGrid>
</VTKFile>
)");
  EXPECT_EQ(folder.n_files(), 1U);
  write_parallel_index(folder / "s.pvtp", {"s_0.vtp"}, {}, {});
  EXPECT_NE(read_bytes(folder / "s.pvtp").find("<PPolyData GhostLevel=\"0\">"), std::string::npos);
}

TEST(ParallelVtk, an_index_that_nobody_could_read_is_refused) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_parallel_index(folder / "u.vtu", {"u_0.vtu"}, {}, {}), IoError);
  EXPECT_THROW(write_parallel_index(folder / "u.pvtu", {}, {}, {}), IoError);
  EXPECT_THROW(write_parallel_index(folder / "no" / "u.pvtu", {"u_0.vtu"}, {}, {}), IoError);
  EXPECT_EQ(folder.n_files(), 0U);
}

void expect_same(const SurfaceData& a, const SurfaceData& b) {
  expect_same_mesh(a.mesh, b.mesh);
  expect_same_fields(a.fields.vertex, b.fields.vertex);
  expect_same_fields(a.fields.face, b.fields.face);
}

void expect_same(const VolumeData& a, const VolumeData& b) {
  expect_same_mesh(a.mesh.face_mesh(), b.mesh.face_mesh());
  EXPECT_EQ(a.mesh.cells().offsets, b.mesh.cells().offsets);
  EXPECT_EQ(a.mesh.cells().indices, b.mesh.cells().indices);
  ASSERT_EQ(a.mesh.n_faces(), b.mesh.n_faces());
  for (Index f = 0; f < a.mesh.n_faces(); ++f) {
    EXPECT_EQ(a.mesh.face_cells()[f].below, b.mesh.face_cells()[f].below);
    EXPECT_EQ(a.mesh.face_cells()[f].above, b.mesh.face_cells()[f].above);
  }
  expect_same_fields(a.fields.vertex, b.fields.vertex);
  expect_same_fields(a.fields.cell, b.fields.cell);
}

/// What a file of the whole mesh gives, in every bit and number.
template <class Mesh>
void check_pieces_with_ids(const Mesh& mesh, const PieceForm& form) {
  const TemporaryFolder folder;
  const auto expected = read_as(write_whole(folder.path(), mesh), mesh);
  for (Index n = 1; n <= 4; ++n)
    for (const auto& parts : {in_blocks(n_elements(mesh), n), scattered(n_elements(mesh), n)})
      expect_same(read_as(write_pieces(folder.path(), mesh, parts, n, form), mesh), expected);
}

TEST(ParallelVtk, pieces_with_ids_give_the_whole_mesh_in_every_bit) {
  PieceForm form{.element_ids = "face_id"};
  for (const FamilyEntry& family : mesh_families()) {
    SCOPED_TRACE(family.name);
    check_pieces_with_ids(family.generate({.level = 1, .jitter = 0.2}), form);
  }
  check_pieces_with_ids(awkward_mesh(), form);
  form = {};
  for (const VolumeFamilyEntry& family : volume_families()) {
    SCOPED_TRACE(family.name);
    check_pieces_with_ids(family.generate({.level = 0, .jitter = 0.2}), form);
  }
  check_pieces_with_ids(mixed_mesh(), form);
  form = {.ids = true,
          .ghosts = false,
          .vertex_ids = "GlobalNodeIds",
          .element_ids = "GlobalElementIds"};
  check_pieces_with_ids(mixed_mesh(), form);
  check_pieces_with_ids(awkward_mesh(), form);
}

/// The same elements by the places of their vertices.
std::vector<std::vector<std::array<double, 3>>> places(const PolygonMesh& mesh) {
  std::vector<std::vector<std::array<double, 3>>> all;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    all.emplace_back();
    for (const Index v : mesh.face(f))
      all.back().push_back({mesh.points()(v, 0), mesh.points()(v, 1), mesh.points()(v, 2)});
    std::sort(all.back().begin(), all.back().end());
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST(ParallelVtk, pieces_without_ids_meet_where_coordinates_are_equal) {
  for (const bool ghosts : {true, false}) {
    const PieceForm form{.ids = false, .ghosts = ghosts};
    const TemporaryFolder folder;
    const PolygonMesh mesh = generate_mesh("sphere-hexagons", {.level = 1});
    const SurfaceData surface =
        read_surface(write_pieces(folder.path(), mesh, scattered(mesh.n_faces(), 3), 3, form));
    EXPECT_EQ(surface.mesh.n_vertices(), mesh.n_vertices());
    EXPECT_EQ(surface.mesh.n_edges(), mesh.n_edges());
    EXPECT_EQ(places(surface.mesh), places(mesh));
    const PolyhedralMesh cells = generate_volume("ball-voronoi", {.level = 0});
    const VolumeData volume =
        read_volume(write_pieces(folder.path(), cells, scattered(cells.n_cells(), 3), 3, form));
    EXPECT_EQ(volume.mesh.n_vertices(), cells.n_vertices());
    EXPECT_EQ(volume.mesh.n_cells(), cells.n_cells());
    EXPECT_EQ(places(volume.mesh.face_mesh()), places(cells.face_mesh()));
    EXPECT_EQ(volume.fields.vertex.size(), 2U);
    EXPECT_EQ(volume.fields.cell.size(), 1U);
  }
}

TEST(ParallelVtk, a_piece_by_itself_is_without_ghosts_and_knows_its_numbers) {
  const TemporaryFolder folder;
  const PolyhedralMesh mesh = mixed_mesh();
  const std::vector<Index> parts{0, 1, 1, 0, 1};
  const auto index = write_pieces(folder.path(), mesh, parts, 2);
  const std::vector<std::filesystem::path> pieces = parallel_pieces(index);
  ASSERT_EQ(pieces, (std::vector{folder / "mesh_0.vtu", folder / "mesh_1.vtu"}));
  for (Index p = 0; p < 2; ++p) {
    const auto piece = std::get<MeshPiece<PolyhedralMesh>>(read_piece(pieces[std::size_t(p)]));
    const MeshPart<PolyhedralMesh> part = part_of(mesh, divide(mesh, 2, parts), p);
    EXPECT_EQ(piece.element_ids,
              p == 0 ? (std::vector<std::int64_t>{0, 3}) : (std::vector<std::int64_t>{1, 2, 4}));
    EXPECT_EQ(piece.mesh.n_cells(), p == 0 ? 2 : 3);
    EXPECT_EQ(piece.vertex_ids, std::vector<std::int64_t>(part.numbers.vertices.begin(),
                                                          part.numbers.vertices.end()));
    EXPECT_EQ(piece.fields.cell.size(), 1U);
    EXPECT_EQ(piece.fields.cell[0].n_rows(), piece.mesh.n_cells());
    EXPECT_EQ(piece.fields.vertex.size(), 2U);
  }
}

/// The message of the error; all name the file.
std::string failure(const std::filesystem::path& path, const std::filesystem::path& culprit) {
  try {
    read_mesh(path);
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find(culprit.string()), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
    EXPECT_TRUE(dynamic_cast<const IoError*>(&error) || dynamic_cast<const InvalidMesh*>(&error));
    return message;
  }
  return "nothing is thrown";
}

void expect_says(const std::string& message, const std::string& says) {
  EXPECT_NE(message.find(says), std::string::npos) << message;
}

TEST(ParallelVtk, what_is_wrong_with_a_piece_is_said_with_its_name) {
  const TemporaryFolder folder;
  const PolygonMesh mesh = generate_mesh("plane-quads", {.level = 1});
  const auto whole = write_whole(folder.path(), mesh);
  const auto write = [&] {
    return write_pieces(folder.path(), mesh, in_blocks(mesh.n_faces(), 3), 3);
  };
  const auto index = write(), piece = folder / "mesh_1.vtp";
  const std::string good = read_bytes(piece), list = read_bytes(index);
  std::filesystem::remove(piece);
  expect_says(failure(index, piece), "No such file");
  write_bytes(piece, "");
  expect_says(failure(index, piece), "is empty");
  // Behind the last array stands </VTKFile> alone.
  for (std::size_t size = 1; size + 40 < good.size(); size += 37) {
    write_bytes(piece, good.substr(0, size));
    EXPECT_NE(failure(index, piece), "nothing is thrown") << size;
  }
  // A piece of another type, the index itself, and with other fields.
  write_bytes(piece, list);
  expect_says(failure(index, piece), "PPolyData");
  std::filesystem::remove(piece);
  std::filesystem::copy_file(whole, piece);
  expect_says(failure(index, piece), "the pieces are not of one mesh");
  // The same piece twice.
  std::filesystem::remove(piece);
  std::filesystem::copy_file(folder / "mesh_0.vtp", piece);
  expect_says(failure(index, piece), "has the global id");
  // A vertex that moved.
  const PolygonMesh moved = mesh.with_points(mesh.points() * 2);
  const TemporaryFolder other;
  write_pieces(other.path(), moved, in_blocks(mesh.n_faces(), 3), 3);
  std::filesystem::remove(piece);
  std::filesystem::copy_file(other / "mesh_1.vtp", piece);
  expect_says(failure(index, piece), "but lies elsewhere");
}

TEST(ParallelVtk, what_is_wrong_with_an_index_is_said) {
  const TemporaryFolder folder;
  const auto path = folder / "mesh.pvtu";
  const auto with = [&](const std::string& inside) {
    return write_bytes(path, "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid>" + inside +
                                 "</PUnstructuredGrid></VTKFile>");
  };
  expect_says(failure(with(""), path), "names no piece");
  expect_says(failure(with("<Piece/>"), path), "names no file");
  expect_says(failure(with("<Piece Source=\"../../no/where.vtu\"/>"), "where.vtu"), "No such file");
  expect_says(failure(with("<Piece Source=\"\"/>"), path), "names no file");
  expect_says(failure(write_bytes(path, "<VTKFile type=\"PUnstructuredGrid\"><PUnstr"), path),
              "unclosed token");
  // Itself.
  expect_says(failure(with("<Piece Source=\"mesh.pvtu\"/>"), path), "PUnstructuredGrid");
  EXPECT_THROW(parallel_pieces(folder / "no.pvtu"), IoError);
}

}  // namespace
}  // namespace carat::test
