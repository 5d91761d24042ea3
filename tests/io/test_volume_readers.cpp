// Volume meshes as other programs write them.

#include "carat/base/error.h"
#include "carat/mesh/cell_kind.h"
#include "foam_case.h"
#include "volume_samples.h"

namespace carat::test {
namespace {

VolumeData read_sample(const std::string& name) {
  for (const VolumeSample& sample : volume_samples())
    if (sample.name == name) return read_volume_as(sample.file, sample.content);
  throw std::out_of_range(name);
}

std::string kinds(const PolyhedralMesh& mesh) {
  std::string text;
  for (Index c = 0; c < mesh.n_cells(); ++c)
    text += std::string(cell_kind_name(cell_kind(mesh, c))) + " ";
  return text;
}

/// "name:type:vertices of its faces".
std::string describe(const VolumeData& data) {
  std::string text;
  for (const BoundaryPatch& patch : data.patches) {
    text += patch.name + ":" + patch.type + ":";
    for (const Index f : patch.faces) {
      const std::set<Index> vertices(data.mesh.face(f).begin(), data.mesh.face(f).end());
      for (const Index v : vertices)
        text += std::to_string(v) + (v == *vertices.rbegin() ? ";" : ",");
    }
    text += " ";
  }
  return text;
}

const FaceSets kTower = {
    {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 4, 5}, {1, 2, 5, 6}, {2, 3, 6, 7}, {0, 3, 4, 7}},
    {{4, 5, 6, 7}, {4, 5, 8}, {5, 6, 8}, {6, 7, 8}, {4, 7, 8}}};

void expect_tower_points(const PolyhedralMesh& mesh) {
  ASSERT_EQ(mesh.n_vertices(), 9);
  for (Index v = 0; v < 9; ++v)
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(mesh.point(v)[k],
                tower_points()[static_cast<std::size_t>(v)][static_cast<std::size_t>(k)]);
}

TEST(ReadMedit, TakesCellsAndMakesPatchesOfBoundaryElements) {
  const VolumeData data = read_sample("medit");
  EXPECT_EQ(face_sets(data.mesh), kTower);
  expect_tower_points(data.mesh);
  EXPECT_EQ(kinds(data.mesh), "hexahedra pyramids ");
  // The quadrilateral between both cells is on no boundary.
  EXPECT_EQ(describe(data), "3::0,1,2,3; 4::4,5,8;5,6,8; ");
  expect_same_fields(data.fields.cell, {{"reference", 1, {1, 2}}});
}

TEST(ReadMedit, ReadsSurfacesOfBothDimensions) {
  const std::string head =
      "MeshVersionFormatted 1\nDimension 2\nVertices 4\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n";
  const SurfaceData flat =
      read_text_as("a.mesh", head + "Quadrilaterals\n1\n1 2 3 4 0\nTriangles 1 1 2 3 5");
  EXPECT_EQ(faces_of(flat.mesh), (Faces{{0, 1, 2, 3}, {0, 1, 2}}));
  EXPECT_EQ(flat.mesh.point(2), Vec3(1, 1, 0));
  expect_same_fields(flat.fields.face, {{"reference", 1, {0, 5}}});
  EXPECT_TRUE(std::holds_alternative<SurfaceData>([&] {
    const TemporaryFolder folder;
    return read_mesh(write_bytes(folder / "a.mesh", head + "Triangles 1 1 2 3 5\nEnd"));
  }()));
}

TEST(ReadGmsh, GivesTheSameInEveryVersionAndEncoding) {
  for (const char* name : {"gmsh2_text", "gmsh2_little"}) {
    const VolumeData data = read_sample(name);
    EXPECT_EQ(face_sets(data.mesh), kTower) << name;
    expect_tower_points(data.mesh);
    EXPECT_EQ(describe(data), "the floor::0,1,2,3; 4::4,5,8; ") << name;
    expect_same_fields(data.fields.cell, {{"physical_group", 1, {1, 2}}});
  }
  // The first two nodes are the other way round in the file.
  FaceSets swapped = kTower;
  swapped[0] = {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 4, 5}, {0, 2, 5, 6}, {2, 3, 6, 7}, {1, 3, 4, 7}};
  for (const char* name : {"gmsh4_text", "gmsh4_little", "gmsh4_big"}) {
    const VolumeData data = read_sample(name);
    EXPECT_EQ(face_sets(data.mesh), swapped) << name;
    EXPECT_EQ(data.mesh.point(0), Vec3(1, 0, 0)) << name;
    EXPECT_EQ(data.mesh.point(8), Vec3(0.5, 0.5, 0.1 + 1.6)) << name;
    EXPECT_EQ(describe(data), "the floor::0,1,2,3; 4::4,5,8; ") << name;
  }
}

TEST(ReadGmsh, ReadsSurfaces) {
  const SurfaceData data = read_text_as(
      "a.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n5 0 0 0\n3 1 0 0\n9 0 1 0\n$EndNodes\n"
      "$Elements\n1\n1 2 0 5 3 9\n$EndElements\n");
  EXPECT_EQ(faces_of(data.mesh), (Faces{{0, 1, 2}}));
}

TEST(ReadVtk, TakesVolumeCellsOfAllVersions) {
  for (const char* name : {"vtk3_text", "vtk3_binary", "vtk5_text", "vtk5_binary"}) {
    const VolumeData data = read_sample(name);
    EXPECT_EQ(kinds(data.mesh), "hexahedra pyramids hexahedra ") << name;
    EXPECT_EQ(face_sets(data.mesh)[0], kTower[0]) << name;
    EXPECT_EQ(face_sets(data.mesh)[1], kTower[1]) << name;
    EXPECT_EQ(data.mesh.n_faces(), 16) << name;
    // The row of the quadrilateral is left out.
    expect_same_fields(data.fields.cell, {{"id", 1, {10, 30, 40}}});
  }
}

TEST(ReadVtk, MakesHexahedraOfStructuredGrids) {
  const auto read = [](const std::string& body) {
    return read_volume_as("a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET " + body);
  };
  const VolumeData image = read(
      "STRUCTURED_POINTS\nDIMENSIONS 3 2 2\nSPACING 0.5 0.25 2\nORIGIN 1 2 3\n"
      "CELL_DATA 2\nSCALARS id int 1\nLOOKUP_TABLE default\n7 8\n");
  EXPECT_EQ(kinds(image.mesh), "hexahedra hexahedra ");
  EXPECT_EQ(image.mesh.point(11), Vec3(2, 2.25, 5));
  expect_same_fields(image.fields.cell, {{"id", 1, {7, 8}}});
  const VolumeData axes = read(
      "RECTILINEAR_GRID\nDIMENSIONS 2 3 2\nX_COORDINATES 2 double\n0 1\n"
      "Y_COORDINATES 3 float\n0 1 4\nZ_COORDINATES 2 double\n5 7\n");
  EXPECT_EQ(kinds(axes.mesh), "hexahedra hexahedra ");
  EXPECT_EQ(axes.mesh.point(5), Vec3(1, 4, 5));
  const VolumeData grid = read(
      "STRUCTURED_GRID\nDIMENSIONS 2 2 2\nPOINTS 8 double\n0 0 0 1 0 0 0 1 0 1 1 0\n"
      "0 0 1 1 0 1 0 1 1 1 1 2\n");
  EXPECT_EQ(kinds(grid.mesh), "hexahedra ");
  EXPECT_EQ(read_text_as("a.vtk",
                         "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\n"
                         "DIMENSIONS 3 1 2\n")
                .mesh.n_faces(),
            2);
}

TEST(ReadVtu, TakesPolyhedraInBothWaysAndSeveralPieces) {
  for (const char* name : {"vtu_old_polyhedra", "vtu_new_polyhedra"}) {
    const VolumeData data = read_sample(name);
    EXPECT_EQ(kinds(data.mesh), "hexahedra hexahedra pyramids ") << name;
    const FaceSets cells = face_sets(data.mesh);
    FaceSets tower = {{}, {}};
    for (std::size_t c = 0; c < 2; ++c)
      for (std::set<Index> face : kTower[c]) {
        std::set<Index> moved;
        for (const Index v : face) moved.insert(v + 8);
        tower[c].insert(moved);
      }
    EXPECT_EQ(cells[1], tower[0]) << name;
    EXPECT_EQ(cells[2], tower[1]) << name;
    expect_same_fields(data.fields.cell, {{"id", 1, {40, 10, 30}}});
  }
}

TEST(ReadOvm, KeepsTheNumbersOfFacesAndReadsProperties) {
  const VolumeData data =
      read_volume_as("a.ovm",
                     "OVM ASCII # by hand\n# comment\nVERTICES\n4\n0 0 0\n1 0 0\n0 1 0\n"
                     "0 0 1 # last\nEdges\n6\n0 1\n1 2\n2 0\n0 3\n1 3\n3 2\nFaces\n4\n"
                     "3 0 2 4\n3 6 9 1\n3 8 10 3\n3 11 7 5\nPolyhedra\n1\n4 0 2 4 6\n"
                     "EProp int \"marks\"\n0\n1\n2\n3\n4\n5\n"
                     "VProp string \"names\"\na b\nVProp\nc\nd\n"
                     "Vertex_Property vec3f \"move it\"\n1 2 3\n4 5 6\n7 8 9\n1 1 1\n"
                     "CProp unsigned int \"kind\"\n5\nFProp bool \"wall\"\n0\n1\n1\n0\n"
                     "VProp double \"u\"\n1e-3\n2\n3\n4\n");
  EXPECT_EQ(faces_of(data.mesh.face_mesh()), (Faces{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}));
  EXPECT_EQ(describe(data), "wall::0,1,3;1,2,3; ");
  expect_same_fields(data.fields.cell, {{"kind", 1, {5}}});
  expect_same_fields(data.fields.vertex, {{"move it", 3, {1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 1, 1}},
                                          {"u", 1, {1e-3, 2, 3, 4}}});
}

TEST(ReadOvm, WithoutCellsIsASurface) {
  const SurfaceData data = read_text_as(
      "a.ovm",
      "OVM ASCII\nVertices\n3\n0 0 0\n1 0 0\n0 1 0\nEdges\n3\n0 1\n1 2\n0 2\nFaces\n1\n3 0 2 5\n"
      "Polyhedra\n0\nFProp double \"q\"\n3.5\n");
  EXPECT_EQ(faces_of(data.mesh), (Faces{{0, 1, 2}}));
  expect_same_fields(data.fields.face, {{"q", 1, {3.5}}});
}

class ReadOpenFoam : public testing::TestWithParam<FoamForm> {};

TEST_P(ReadOpenFoam, TakesMeshAndPatches) {
  const TemporaryFolder folder;
  const PolyhedralMesh mesh = mixed_mesh();
  const VolumeData data = read_volume(FoamCase(GetParam()).write(folder / "case", mesh));
  EXPECT_EQ(face_sets(data.mesh), face_sets(mesh));
  EXPECT_TRUE(data.mesh.repairs().turned_faces.empty());
  if (GetParam() == FoamForm::SinglePrecision) {
    EXPECT_EQ(data.mesh.points(), mesh.points().cast<float>().cast<double>());
  } else {
    expect_same_cells(data.mesh, mesh);
  }
  Index n_boundary = 0;
  for (const FaceCells& cells : mesh.face_cells()) n_boundary += cells.boundary() ? 1 : 0;
  ASSERT_EQ(data.patches.size(), 2u);
  EXPECT_EQ(data.patches[0].name + data.patches[0].type, "inletpatch");
  EXPECT_EQ(data.patches[1].name + data.patches[1].type, "side wallswall");
  EXPECT_EQ(data.patches[0].faces.size(), 1u);
  EXPECT_EQ(data.patches[1].faces.size(), static_cast<std::size_t>(n_boundary - 1));
}

INSTANTIATE_TEST_SUITE_P(Forms, ReadOpenFoam,
                         testing::Values(FoamForm::Text, FoamForm::Binary32, FoamForm::Binary64,
                                         FoamForm::BigEndian, FoamForm::SinglePrecision));

TEST(ReadOpenFoamPath, MayBeAnythingThatMeansTheMesh) {
  const TemporaryFolder folder;
  FoamCase(FoamForm::Text).write(folder / "case", mixed_mesh());
  write_bytes(folder / "case/a.foam", "");
  for (const char* path :
       {"case", "case/", "case/constant", "case/constant/polyMesh", "case/constant/polyMesh/",
        "case/constant/polyMesh/owner", "case/a.foam", "case/missing.foam"})
    EXPECT_EQ(read_volume(folder / path).mesh.n_cells(), 5) << path;
  write_bytes(folder / "alone.foam", "");
  for (const char* path : {"alone.foam", ""}) {
    try {
      read_volume(folder / path);
      FAIL() << path;
    } catch (const IoError& error) {
      EXPECT_NE(std::string(error.what()).find("OpenFOAM"), std::string::npos) << error.what();
    }
  }
}

TEST(ReadOpenFoamPath, UnpacksGzip) {
  // "labels" packed by gzip: the owners of the one-cell case below.
  const TemporaryFolder folder;
  Points points(4, 3);
  points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  const PolyhedralMesh mesh = PolyhedralMesh::from_tets(
      points, (PolyhedralMesh::CellArray::PlainObject(1, 4) << 0, 1, 2, 3).finished());
  FoamCase(FoamForm::Text).write(folder / "case", mesh);
  const auto owner = folder / "case/constant/polyMesh/owner";
  ASSERT_EQ(std::system(("gzip '" + owner.string() + "'").c_str()), 0);
  ASSERT_FALSE(std::filesystem::exists(owner));
  EXPECT_EQ(read_volume(folder / "case").mesh.n_cells(), 1);
  const std::string packed = read_bytes(owner.string() + ".gz");
  for (std::size_t size = 1; size < packed.size(); size += 7) {
    write_bytes(owner.string() + ".gz", packed.substr(0, size));
    EXPECT_THROW(read_volume(folder / "case"), IoError) << size;
  }
}

TEST(ReadOpenFoamPath, UnderstandsShortAndOldForms) {
  const TemporaryFolder folder;
  Points points(4, 3);
  points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  const auto path = folder / "case/constant/polyMesh";
  std::filesystem::create_directories(path);
  const std::string header = "FoamFile { version 2.0; format ascii; class x; object y; }\n";
  write_bytes(path / "points", header + "4((0 0 0)(1 0 0)(0 1 0)(0 0 1))");
  write_bytes(path / "faces", header + "4(3(0 2 1)3(0 1 3) // one\n3(1 2 3)\n3 (2 0 3))");
  write_bytes(path / "owner", header + "4{0}");
  write_bytes(path / "neighbour", header + "4(-1 -1 -1 -1)");
  const VolumeData data = read_volume(folder / "case");
  EXPECT_EQ(kinds(data.mesh), "tetrahedra ");
  EXPECT_TRUE(data.patches.empty());
  write_bytes(path / "neighbour", header + "0()");
  EXPECT_EQ(read_volume(folder / "case").mesh.n_cells(), 1);
}

}  // namespace
}  // namespace carat::test
