// Volume files that are no mesh: one clear error with path, place and remedy.

#include "carat/base/error.h"
#include "foam_case.h"
#include "volume_samples.h"

namespace carat::test {
namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

const std::string kHuge = "1000000000000";

/// The message of the error that reading the path gives, without the path; "" if there is none.
std::string message_of(const std::filesystem::path& path) {
  try {
    read_volume(path);
  } catch (const Error& error) {
    const std::string message = error.what(), prefix = path.string() + ": ";
    EXPECT_TRUE(message.starts_with(prefix)) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message.substr(std::min(prefix.size(), message.size()));
  }
  return "";
}

void expect_parts(const std::string& message, const std::vector<std::string>& parts) {
  ASSERT_NE(message, "") << "no error";
  std::size_t from = 0;
  for (const std::string& part : parts) {
    from = message.find(part, from);
    EXPECT_NE(from, std::string::npos) << "'" << part << "' is not in: " << message;
  }
}

struct BadVolume {
  std::string name, file, content;
  std::vector<std::string> message;  ///< parts that the message must have, in this order
};

std::vector<BadVolume> bad_volumes() {
  const std::string tet =
      "OVM ASCII\nVertices\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\nEdges\n6\n0 1\n1 2\n2 0\n0 3\n1 3\n3 2\n"
      "Faces\n4\n3 0 2 4\n3 6 9 1\n3 8 10 3\n3 11 7 5\nPolyhedra\n1\n4 0 2 4 6\n";
  const std::string medit = medit_sample();
  const std::string gmsh2 = gmsh_2_sample(GmshForm::Text), gmsh4 = gmsh_4_sample(GmshForm::Text);
  const std::string vtk = vtk_volume_sample(3, false), old_vtu = vtu_volume_sample(false),
                    new_vtu = vtu_volume_sample(true);
  return {
      {"surface",
       "a.obj",
       "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
       {"surface mesh (1 faces", "volume mesh is needed"}},
      {"ovm_garbage", "a.ovm", "\x89PNG\r\n\x1a\n", {"line 1", "OVM ASCII"}},
      {"ovm_binary", "a.ovm", "OVM BINARY\n", {"OVM ASCII"}},
      {"ovm_nan", "a.ovm", replaced(tet, "1 0 0", "1 nan 0"), {"line 5", "nan", "finite"}},
      {"ovm_huge_vertices",
       "a.ovm",
       replaced(tet, "\n4\n", "\n" + kHuge + "\n"),
       {"line 3", kHuge + " vertices"}},
      {"ovm_huge_edges", "a.ovm", replaced(tet, "\n6\n", "\n" + kHuge + "\n"), {kHuge + " edges"}},
      {"ovm_huge_face",
       "a.ovm",
       replaced(tet, "\n3 0 2 4", "\n" + kHuge + " 0 2 4"),
       {kHuge + " halfedges"}},
      {"ovm_huge_cells",
       "a.ovm",
       replaced(tet, "Polyhedra\n1", "Polyhedra\n" + kHuge),
       {kHuge + " polyhedra"}},
      {"ovm_negative", "a.ovm", replaced(tet, "Polyhedra\n1", "Polyhedra\n-1"), {"-1 polyhedra"}},
      {"ovm_edge_range",
       "a.ovm",
       replaced(tet, "\n3 2\n", "\n3 4\n"),
       {"line 15", "vertex 4 does not exist"}},
      {"ovm_face_range",
       "a.ovm",
       replaced(tet, "3 0 2 4", "3 0 2 12"),
       {"line 18", "halfedge 12", "12, numbered"}},
      {"ovm_face_open",
       "a.ovm",
       replaced(tet, "3 0 2 4", "3 0 2 5"),
       {"line 18", "face 0", "vertex 0", "vertex 2"}},
      {"ovm_cell_range",
       "a.ovm",
       replaced(tet, "4 0 2 4 6", "4 0 2 4 8"),
       {"line 24", "halfface 8"}},
      {"ovm_cell_negative",
       "a.ovm",
       replaced(tet, "4 0 2 4 6", "4 0 2 4 -6"),
       {"line 24", "halfface -6"}},
      {"ovm_cell_open", "a.ovm", replaced(tet, "4 0 2 4 6", "3 0 2 4"), {"cell 0", "3 faces"}},
      {"ovm_cell_twice", "a.ovm", replaced(tet, "4 0 2 4 6", "4 0 2 4 5"), {"cell 0"}},
      {"ovm_section", "a.ovm", replaced(tet, "Edges", "Elephants"), {"line 8", "Edges"}},
      {"ovm_property_short", "a.ovm", tet + "VProp double \"u\"\n1\n2\n", {"values of a property"}},
      {"ovm_property_huge",
       "a.ovm",
       tet + "VProp vec2000000000d \"u\"\n1\n2\n",
       {"values of a property"}},
      {"medit_version", "a.mesh", "MeshVersionFormatted 7\n", {"version 7"}},
      {"medit_no_vertices", "a.mesh", "MeshVersionFormatted 2\nDimension 3\nEnd\n", {"Vertices"}},
      {"medit_huge",
       "a.mesh",
       replaced(medit, "Vertices\n9", "Vertices\n" + kHuge),
       {"line 6", kHuge + " vertices"}},
      {"medit_huge_cells",
       "a.mesh",
       replaced(medit, "Hexahedra\n1", "Hexahedra\n" + kHuge),
       {kHuge + " elements"}},
      {"medit_nan", "a.mesh", replaced(medit, "\n0 0 0 0", "\n0 nan 0 0"), {"line 7", "nan"}},
      {"medit_range",
       "a.mesh",
       replaced(medit, "5 6 7 8 9 2", "5 6 7 8 10 2"),
       {"line 36", "vertex 10", "1 to 9"}},
      {"medit_zero",
       "a.mesh",
       replaced(medit, "5 6 7 8 9 2", "5 6 7 8 0 2"),
       {"line 36", "vertex 0"}},
      {"medit_dimension", "a.mesh", replaced(medit, "\n 3\n", "\n 4\n"), {"dimension 4"}},
      {"medit_curved",
       "a.mesh",
       replaced(medit, "Edges", "TetrahedraP2"),
       {"'TetrahedraP2'", "curved"}},
      {"medit_early",
       "a.mesh",
       "MeshVersionFormatted 2\nTriangles\n1\n1 2 3 0\n",
       {"before the vertices"}},
      {"gmsh_version",
       "a.msh",
       "$MeshFormat\n4 0 8\n$EndMeshFormat\n",
       {"line 2", "4.0", "save it"}},
      {"gmsh_version_1", "a.msh", "$NOD\n1\n1 0 0 0\n$ENDNOD\n", {"$EndNOD"}},
      {"gmsh_no_format",
       "a.msh",
       "$Comments\nx\n$EndComments\n$Nodes\n1\n",
       {"$MeshFormat is missing"}},
      {"gmsh2_huge_nodes",
       "a.msh",
       replaced(gmsh2, "$Nodes\n9", "$Nodes\n" + kHuge),
       {kHuge + " nodes"}},
      {"gmsh2_huge_elements",
       "a.msh",
       replaced(gmsh2, "$Elements\n6", "$Elements\n" + kHuge),
       {kHuge + " elements"}},
      {"gmsh2_nan", "a.msh", replaced(gmsh2, "1 0 0 0", "1 0 nan 0"), {"node 1", "nan"}},
      {"gmsh2_twice",
       "a.msh",
       replaced(gmsh2, "\n2 1 0 0", "\n1 1 0 0"),
       {"node 1 is there twice"}},
      {"gmsh2_no_node", "a.msh", replaced(gmsh2, "5 6 7 8 9 ", "5 6 7 8 10 "), {"node 10"}},
      {"gmsh2_curved", "a.msh", replaced(gmsh2, "\n6 7 2", "\n6 11 2"), {"type 11", "first order"}},
      {"gmsh2_end",
       "a.msh",
       replaced(gmsh2, "$EndElements", "$Something"),
       {"$EndElements is missing"}},
      {"gmsh2_block",
       "a.msh",
       replaced(gmsh_2_sample(GmshForm::Little), "$Elements\n6", "$Elements\n0"),
       {"volume mesh is needed"}},
      {"gmsh4_huge_nodes",
       "a.msh",
       replaced(gmsh4, "$Nodes\n2 9", "$Nodes\n2 " + kHuge),
       {kHuge + " nodes"}},
      {"gmsh4_huge_entities",
       "a.msh",
       replaced(gmsh4, "$Entities\n1 1 2 2", "$Entities\n1 1 " + kHuge + " 2"),
       {kHuge}},
      {"gmsh4_fewer",
       "a.msh",
       replaced(gmsh4, "$Elements\n5 5", "$Elements\n5 6"),
       {"5 elements", "6"}},
      {"gmsh4_no_node",
       "a.msh",
       replaced(gmsh4, "5 50 60 70 80 90", "5 50 60 70 80 91"),
       {"node 91"}},
      {"vtk_polyhedron_short",
       "a.vtk",
       replaced(vtk, "5 4 4 5 6 7 3", "6 4 4 5 6 7 3"),
       {"cell 2", "too early"}},
      {"vtk_polyhedron_long",
       "a.vtk",
       replaced(vtk, "5 4 4 5 6 7 3", "4 4 4 5 6 7 3"),
       {"cell 2", "longer"}},
      {"vtk_polyhedron_face",
       "a.vtk",
       replaced(vtk, "5 4 4 5 6 7 3", "5 " + kHuge + " 4 5 6 7 3"),
       {"cell 2", kHuge}},
      {"vtk_polyhedron_range",
       "a.vtk",
       replaced(vtk, "5 4 4 5 6 7 3", "5 4 4 99 6 7 3"),
       {"cell 2", "vertex 99"}},
      {"vtk_quadratic",
       "a.vtk",
       replaced(vtk, "12 9 42 11", "24 9 42 11"),
       {"cell 0", "quadratic tetrahedron", "first order"}},
      {"vtk_few_points", "a.vtk", replaced(vtk, "12 9 42 11", "10 9 42 11"), {"8 vertices"}},
      {"vtk_huge_image",
       "a.vtk",
       "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 100000 100000 "
       "100\n",
       {"DIMENSIONS"}},
      {"vtk_huge_axes",
       "a.vtk",
       "# vtk DataFile Version 3.0\nt\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 " + kHuge,
       {"DIMENSIONS"}},
      {"vtk_axes",
       "a.vtk",
       "# vtk DataFile Version 3.0\nt\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 "
       "2\nX_COORDINATES 3 float\n0 1 2\n",
       {"3 coordinates X for 2"}},
      {"vtu_no_faces",
       "a.vtu",
       replaced(old_vtu, "Name=\"faces\"", "Name=\"other\""),
       {"cell 3", "faces"}},
      {"vtu_no_offsets",
       "a.vtu",
       replaced(old_vtu, "faceoffsets", "other"),
       {"faceoffsets", "missing"}},
      {"vtu_far_offsets",
       "a.vtu",
       replaced(old_vtu, "-1 -1 22", "-1 -1 2200"),
       {"'faces'", "2200"}},
      {"vtu_huge_offsets",
       "a.vtu",
       replaced(old_vtu, "-1 -1 22", "-1 -1 " + kHuge),
       {"'faces'", kHuge}},
      {"vtu_short_offsets",
       "a.vtu",
       replaced(old_vtu, "-1 -1 22", "-1 -1"),
       {"'faceoffsets'", "truncated"}},
      {"vtu_cut_stream", "a.vtu", replaced(old_vtu, "-1 -1 22", "-1 -1 20"), {"cell 3"}},
      {"vtu_stream_range",
       "a.vtu",
       replaced(old_vtu, "7 4 8</", "7 4 900</"),
       {"cell 3", "vertex 908"}},
      {"vtu_face_range",
       "a.vtu",
       replaced(new_vtu, ">0 1 2 3 4<", ">0 1 2 3 9<"),
       {"'face_offsets'", "10"}},
      {"vtu_face_negative", "a.vtu", replaced(new_vtu, ">0 1 2 3 4<", ">0 1 2 3 -4<"), {"face -4"}},
      {"vtu_face_of_three",
       "a.vtu",
       replaced(new_vtu, ">0 1 2 3 4<", ">0 1 1 1 4<"),
       {"face 1", "two cells"}},
      {"vtu_face_offsets",
       "a.vtu",
       replaced(new_vtu, "4 7 10 13 16", "4 7 3 13 16"),
       {"face_offsets", "ascend"}},
  };
}

class BadVolumeInput : public testing::TestWithParam<BadVolume> {};

TEST_P(BadVolumeInput, GivesOneClearLine) {
  const TemporaryFolder folder;
  expect_parts(message_of(write_bytes(folder / GetParam().file, GetParam().content)),
               GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(Files, BadVolumeInput, testing::ValuesIn(bad_volumes()),
                         [](const auto& test) { return test.param.name; });

TEST(BadVolume, IsRefusedByReadSurface) {
  const TemporaryFolder folder;
  for (const VolumeSample& known : volume_samples()) {
    try {
      read_surface(write_bytes(folder / known.file, known.content));
      FAIL() << known.name;
    } catch (const IoError& error) {
      EXPECT_NE(std::string(error.what()).find("surface mesh is needed"), std::string::npos)
          << error.what();
    }
  }
}

struct BadCase {
  std::string file, from, to;
  std::vector<std::string> message;
};

TEST(BadOpenFoam, NamesFileAndPlace) {
  const std::string n = std::to_string(mixed_mesh().n_faces());
  const std::vector<BadCase> bad = {
      {"points", "FoamFile\n{", "NoFile\n{", {"points: ", "FoamFile"}},
      {"points", "ascii", "yaml", {"points: ", "'yaml'"}},
      {"points", "\n20\n(", "\n" + kHuge + "\n(", {"points: line", kHuge + " points"}},
      {"points", "(7 8 9)", "(7 nan 9)", {"points: line", "point 18", "nan"}},
      {"points", "(7 8 9)", "(7 8)", {"points: line"}},
      {"points", "(7 8 9)", "(7 8 9 9)", {"points: line", "')'"}},
      {"points", "\n20\n(", "\n21\n(", {"points: line"}},
      {"points", "\n20\n(", "\n19\n(", {"points: line", "')'"}},
      {"faces", "\n" + n + "\n(", "\n" + kHuge + "\n(", {"faces: line", kHuge + " faces"}},
      {"faces", "\n4(", "\n" + kHuge + "(", {"faces: line", kHuge}},
      {"faces", "\n4(", "\n-4(", {"faces: line", "-4"}},
      {"faces", "4(1 ", "4(99 ", {"vertex 99"}},
      {"owner", "\n" + n + "\n(", "\n" + kHuge + "\n(", {"owner: line", kHuge}},
      {"owner", "(\n0", "(\n-7", {"owner: line", "-7"}},
      {"owner", "(\n0", "(\n99999999999", {"owner: line", "99999999999"}},
      {"owner", "(\n0", "(\n1000000", {"cell 1000000"}},
      {"owner", "\n" + n + "\n(", "\n" + kHuge + "{0}\n(", {"owner: line", kHuge + " equal"}},
      {"neighbour", "(\n", "(\n0 0 0 ", {"neighbour: line"}},
      {"boundary", "\n2\n(", "\nx\n(", {"boundary: line", "'x'"}},
      {"boundary",
       "nFaces          1;",
       "nFaces          1000;",
       {"boundary: patch 'inlet'", "1000"}},
      {"boundary", "startFace       ", "startFace       -", {"boundary: patch 'inlet'"}},
      {"boundary",
       "startFace       ",
       "startFace       0; was ",
       {"boundary: patch 'inlet'", "not on the boundary"}},
      {"boundary",
       "nFaces          1;",
       "nFaces          2;",
       {"boundary: patch 'side walls'", "in another patch"}},
      {"boundary", "    }\n)", "    }\n", {"boundary: line", "too early"}},
      {"boundary", "1(wall);", "1(wall;", {"boundary: line"}},
  };
  const TemporaryFolder folder;
  const auto path = FoamCase(FoamForm::Text).write(folder / "case", mixed_mesh());
  for (const BadCase& one : bad) {
    SCOPED_TRACE(one.file + ": " + one.from + " -> " + one.to);
    const auto file = path / "constant/polyMesh" / one.file;
    const std::string intact = read_bytes(file);
    write_bytes(file, replaced(intact, one.from, one.to));
    expect_parts(message_of(path), one.message);
    write_bytes(file, intact);
  }
  for (const char* name : {"points", "neighbour"}) {
    const auto file = path / "constant/polyMesh" / name;
    const std::string intact = read_bytes(file);
    std::filesystem::remove(file);
    expect_parts(message_of(path), {std::string(name) + ": ", "No such file"});
    write_bytes(file, intact);
  }
}

}  // namespace
}  // namespace carat::test
