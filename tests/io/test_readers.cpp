// Variants of the formats as other programs write them.

#include "carat/base/error.h"
#include "io_support.h"
#include "sample_files.h"

namespace carat::test {
namespace {

SurfaceData read_sample(const std::string& name) {
  for (const SampleFile& sample : sample_files())
    if (sample.name == name) return read_text_as(sample.file, sample.content);
  throw std::out_of_range(name);
}

TEST(ReadObj, UnderstandsAllFormsOfFaces) {
  const SurfaceData data = read_text_as("a.obj",
                                        "# a comment\r\n"
                                        "mtllib a.mtl\r\n"
                                        "o thing\r\n"
                                        "v 0 0 0\r\n"
                                        "v 1 0 0 1.0\r\n"
                                        "v 1 1 0 0.5 0.5 0.5 # colours\r\n"
                                        "v 0 +1 1e-1\r\n"
                                        "vt 0 0\r\nvn 0 0 1\r\n"
                                        "usemtl red\r\ns off\r\ng a b\r\n"
                                        "f 1 2 3\r\n"
                                        "f 1/1 2/1 3/1 4/1\r\n"
                                        "f 1//1 2//1 4//1\r\n"
                                        "  f\t1/1/1 3/1/1 4/1/1   # end\r\n"
                                        "f -4 -3 \\\r\n -2 \\\r\n -1\r\n"
                                        "l 1 2\r\np 1\r\n"
                                        "f 5 1 2\r\n"
                                        "v 9 9 9");
  EXPECT_EQ(faces_of(data.mesh),
            (Faces{{0, 1, 2}, {0, 1, 2, 3}, {0, 1, 3}, {0, 2, 3}, {0, 1, 2, 3}, {4, 0, 1}}));
  ASSERT_EQ(data.mesh.n_vertices(), 5);
  EXPECT_EQ(data.mesh.point(3), Vec3(0, 1, 0.1));
  EXPECT_EQ(data.mesh.point(4), Vec3(9, 9, 9));
}

TEST(ReadObj, RoundsNumbersCorrectly) {
  const SurfaceData data = read_text_as("a.obj",
                                        "v 0.1 1e-400 -1e-400\n"
                                        "v 9007199254740993 1e23 4.9e-324\n"
                                        "v 2.2250738585072011e-308 8.5e15 123456789012345678\n");
  const std::vector<double> expected = {0.1,
                                        0.0,
                                        -0.0,
                                        9007199254740992.0,
                                        1e23,
                                        5e-324,
                                        2.2250738585072011e-308,
                                        8.5e15,
                                        123456789012345680.0};
  ASSERT_EQ(data.mesh.n_vertices(), 3);
  EXPECT_TRUE(same_bits(data.mesh.points().data(), expected.data(), expected.size()));
}

TEST(ReadOff, PassesOverExtraColumns) {
  for (const char* header : {"OFF", "COFF", "NOFF", "STOFF", "CNOFF", "STCNOFF"}) {
    const SurfaceData data = read_text_as(
        "a.off", std::string("# first\n") + header +
                     " 4 2 5\n0 0 0 .1 .2 .3 .4\n\n1 0 0 1 # a comment\n# another\n1 1 0\n"
                     "0 1 0.5 9 9 9 9 9\r\n4 0 1 2 3 0.5 0.5 0.5\n3 0 1 2 7\n");
    EXPECT_EQ(faces_of(data.mesh), (Faces{{0, 1, 2, 3}, {0, 1, 2}})) << header;
    EXPECT_EQ(data.mesh.point(3), Vec3(0, 1, 0.5)) << header;
  }
}

TEST(ReadOff, ReadsBinaryWithNormalsAndColours) {
  const SurfaceData data = read_sample("off_binary");
  EXPECT_EQ(faces_of(data.mesh), (Faces{{0, 1, 3, 2}, {0, 1, 3}}));
  EXPECT_EQ(data.mesh.point(3), Vec3(1, 1, 0.25));
}

TEST(ReadOff, CountsWithoutEdges) {
  EXPECT_EQ(read_text_as("a.off", "OFF\n3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2").mesh.n_faces(), 1);
}

TEST(ReadPly, GivesTheSameInEveryEncoding) {
  for (const char* name : {"ply_text", "ply_little", "ply_big"}) {
    const SurfaceData data = read_sample(name);
    EXPECT_EQ(faces_of(data.mesh), (Faces{{0, 1, 3, 2}, {0, 1, 3}})) << name;
    EXPECT_EQ(data.mesh.point(2).y(), 1) << name;
    expect_same_fields(data.fields.vertex, {{"red", 1, {0, 50, 100, 150}}});
    expect_same_fields(data.fields.face, {{"quality", 1, {1.5, 2.5}}});
  }
}

TEST(ReadPly, TakesAnyOrderTypesAndExtraElements) {
  Bytes bytes(std::endian::big);
  bytes.text(
      "ply\r\nformat binary_big_endian 1.0\r\nobj_info x\r\n"
      "element material 1\r\nproperty list ushort uchar name\r\nproperty int8 kind\r\n"
      "element face 1\r\nproperty list uint8 float texcoord\r\nproperty int64x id\r\n");
  EXPECT_THROW(read_text_as("a.ply", bytes.str()), IoError);

  Bytes good(std::endian::big);
  good.text(
      "ply\r\nformat binary_big_endian 1.0\r\nobj_info x\r\n"
      "element material 1\r\nproperty list ushort uchar name\r\nproperty int8 kind\r\n"
      "element face 1\r\nproperty list uint8 float texcoord\r\nproperty short flags\r\n"
      "property list uint32 uint16 vertex_index\r\n"
      "element vertex 3\r\nproperty float32 nx\r\nproperty float32 ny\r\nproperty float32 nz\r\n"
      "property int16 z\r\nproperty list uchar uchar tags\r\nproperty float64 y\r\n"
      "property uint x\r\nproperty double v_0\r\nproperty double v_1\r\n"
      "element edge 1\r\nproperty int a\r\nproperty int b\r\nend_header\r\n");
  good.add<std::uint16_t>(2).add<char>('a').add<char>('b').add<std::int8_t>(-3);
  good.add<std::uint8_t>(2).add(0.5f).add(0.25f).add<std::int16_t>(-7);
  good.add<std::uint32_t>(3).add_all<std::uint16_t>({2, 0, 1});
  for (int v = 0; v < 3; ++v) {
    good.add_all<float>({0, 0, float(v)}).add<std::int16_t>(static_cast<std::int16_t>(-v));
    good.add<std::uint8_t>(1).add<std::uint8_t>(9);
    good.add(v * 0.1).add<std::uint32_t>(4000000000u).add(1.0 * v).add(2.0 * v);
  }
  good.add_all<int>({0, 1});
  const SurfaceData data = read_text_as("a.ply", good.str());
  EXPECT_EQ(faces_of(data.mesh), (Faces{{2, 0, 1}}));
  EXPECT_EQ(data.mesh.point(2), Vec3(4000000000.0, 0.2, -2));
  expect_same_fields(data.fields.vertex,
                     {{"normals", 3, {0, 0, 0, 0, 0, 1, 0, 0, 2}}, {"v", 2, {0, 0, 1, 2, 2, 4}}});
  expect_same_fields(data.fields.face, {{"flags", 1, {-7}}});
}

TEST(ReadStl, WeldsExactlyInOrderOfFirstAppearance) {
  for (const char* name : {"stl_text", "stl_binary"}) {
    const SurfaceData data = read_sample(name);
    EXPECT_EQ(data.mesh.n_vertices(), 4) << name;  // 0 and -0 are the same place
    EXPECT_EQ(data.mesh.n_faces(), 2) << name;
    EXPECT_EQ(data.mesh.face(0)[0], 0) << name;
    EXPECT_EQ(data.mesh.face(0)[2], 2) << name;
  }
  const SurfaceData near =
      read_text_as("a.stl",
                   "solid\nfacet\nvertex 0.1 0 0\nvertex 1 0 0\nvertex 0 1 0\nendfacet\n"
                   "facet\nvertex 0.10000000000000002 0 0\nvertex 1 0 0\nvertex 0 1 0\nendfacet\n"
                   "endsolid\n");
  EXPECT_EQ(faces_of(near.mesh), (Faces{{0, 1, 2}, {3, 1, 2}}));
}

TEST(ReadStl, BinaryMayStartWithSolid) {
  std::string content = read_bytes("/dev/null") + binary_stl();
  content.replace(0, 11, "solid facet");
  EXPECT_EQ(read_text_as("a.stl", content).mesh.n_faces(), 2);
}

TEST(ReadVtk, SelectsRowsOfTheFaces) {
  const SurfaceData data = read_sample("vtk_binary");
  EXPECT_EQ(faces_of(data.mesh), (Faces{{0, 1, 3, 2}, {0, 1, 3}}));
  expect_same_fields(data.fields.face, {{"number", 1, {20, 30}}});
  ASSERT_EQ(data.fields.vertex.size(), 1u);
  EXPECT_EQ(data.fields.vertex[0].name, "move");
  EXPECT_EQ(data.fields.vertex[0].components, 3);
  EXPECT_EQ(data.fields.vertex[0].values[11], 0.1 * 11);
}

TEST(ReadVtk, ReadsVersionFiveAndTurnsPixels) {
  const SurfaceData data = read_sample("vtk_binary_5");
  EXPECT_EQ(faces_of(data.mesh), (Faces{{0, 1, 3, 2}, {0, 1, 3}}));
  ASSERT_EQ(data.fields.vertex.size(), 1u);
  EXPECT_EQ(data.fields.vertex[0].name, "heat flow");
  EXPECT_EQ(data.fields.vertex[0].components, 2);
  EXPECT_EQ(data.fields.vertex[0].values[7], 3.5);
}

TEST(ReadVtk, ReadsEveryKindOfAttribute) {
  const SurfaceData data = read_text_as(
      "a.vtk",
      "# vtk DataFile Version 3.0\ntitle\nascii\ndataset unstructured_grid\n"
      "FIELD FieldData 1\nTIME 1 1 double\n0.5\n"
      "POINTS 3 double 0 0 0 1 0 0\n0 1 0\nMETADATA\nINFORMATION 0\n\n"
      "CELLS 2 9\n3 0 1 2\n4 0 1 2 0\nCELL_TYPES 2\n5\n7\n"
      "POINT_DATA 3\n"
      "SCALARS s double\nLOOKUP_TABLE mine\n1 2 3\n"
      "LOOKUP_TABLE mine 1\n0 0 0 1\n"
      "SCALARS s2 int 2\nLOOKUP_TABLE default\n1 2 3 4 5 6\n"
      "COLOR_SCALARS c 3\n0 0.5 1 0 0 0 1 1 1\n"
      "NORMALS n float\n0 0 1 0 0 1 0 0 1\n"
      "TEXTURE_COORDINATES t 2 float\n0 0 1 0 0 1\n"
      "TENSORS T float\n1 2 3 4 5 6 7 8 9\n1 2 3 4 5 6 7 8 9\n1 2 3 4 5 6 7 8 9\n"
      "FIELD FieldData 2\na 1 3 float\n1 2 nan\nMETADATA\nINFORMATION 0\n\nb 1 3 int\n4 5 6\n"
      "CELL_DATA 2\nSCALARS q float\n7\n8\n");
  std::string names;
  for (const Field& field : data.fields.vertex)
    names += field.name + std::to_string(field.components) + " ";
  EXPECT_EQ(names, "s1 s22 c3 n3 t2 T9 a1 b1 ");
  EXPECT_EQ(data.fields.vertex[2].values[1], 128);
  expect_same_fields(data.fields.face, {{"q", 1, {7, 8}}});
  EXPECT_EQ(data.mesh.n_faces(), 2);
}

TEST(ReadVtp, TakesPolygonsAndStripsAndPassesOverVertices) {
  const SurfaceData data = read_sample("vtp_text");
  EXPECT_EQ(faces_of(data.mesh), (Faces{{0, 1, 3, 2}, {0, 1, 2}, {2, 1, 3}}));
  expect_same_fields(data.fields.face, {{"id", 1, {8, 9, 9}}});
}

TEST(ReadVtu, TakesTwoDimensionalCells) {
  const SurfaceData data = read_sample("vtu_text");
  EXPECT_EQ(faces_of(data.mesh), (Faces{{0, 1, 3, 2}, {0, 1, 3}}));
  EXPECT_EQ(data.mesh.point(3), Vec3(1, 1, 0.1));
  expect_same_fields(data.fields.face, {{"id", 1, {8, 9}}});
  expect_same_fields(data.fields.vertex, {{"u", 1, {1, 2, 3, 4.5}}});
}

TEST(ReadSurface, PassesOverAByteOrderMark) {
  EXPECT_EQ(read_text_as("a.off", "\xEF\xBB\xBFOFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
                .mesh.n_faces(),
            1);
}

}  // namespace
}  // namespace carat::test
