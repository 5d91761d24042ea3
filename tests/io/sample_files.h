#pragma once
// One small valid file of every format and encoding.

#include <string>
#include <vector>

#include "io_support.h"

namespace carat::test {

struct SampleFile {
  std::string name;  ///< of the sample, for test names
  std::string file;  ///< file name with extension
  std::string content;
};

inline std::string ply_header(const std::string& encoding, const std::string& n_vertices = "4") {
  return "ply\nformat " + encoding + " 1.0\ncomment made by hand\nelement vertex " + n_vertices +
         "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\n"
         "element face 2\nproperty list uchar int vertex_indices\nproperty float quality\n"
         "end_header\n";
}

inline std::string binary_ply(std::endian order) {
  Bytes bytes(order);
  bytes.text(
      ply_header(order == std::endian::little ? "binary_little_endian" : "binary_big_endian"));
  for (int v = 0; v < 4; ++v)
    bytes.add(double(v & 1)).add(double(v >> 1)).add(0.5).add(static_cast<unsigned char>(50 * v));
  bytes.add<unsigned char>(4).add_all<int>({0, 1, 3, 2}).add(1.5f);
  bytes.add<unsigned char>(3).add_all<int>({0, 1, 3}).add(2.5f);
  return bytes.str();
}

inline std::string binary_stl() {
  Bytes bytes(std::endian::little);
  bytes.text(std::string(80, 's')).add<std::uint32_t>(2);
  for (int t = 0; t < 2; ++t) {
    bytes.add_all<float>({0, 0, 1});
    bytes.add_all<float>({0, 0, t == 0 ? 0.0f : -0.0f, 1, float(t), 0, 1 - float(t), 1, 0});
    bytes.add<std::uint16_t>(0);
  }
  return bytes.str();
}

inline std::string binary_off() {
  Bytes bytes(std::endian::big);
  bytes.text("NOFF BINARY\n").add_all<int>({4, 2, 0});
  for (int v = 0; v < 4; ++v) bytes.add_all<float>({float(v & 1), float(v >> 1), 0.25f, 0, 0, 1});
  bytes.add<int>(4).add_all<int>({0, 1, 3, 2}).add<int>(0);
  bytes.add<int>(3).add_all<int>({0, 1, 3}).add<int>(4).add_all<float>({1, 0, 0, 1});
  return bytes.str();
}

inline std::string binary_vtk() {
  Bytes bytes(std::endian::big);
  bytes.text("# vtk DataFile Version 3.0\ntitle\nBINARY\nDATASET POLYDATA\nPOINTS 4 float\n");
  for (int v = 0; v < 4; ++v) bytes.add_all<float>({float(v & 1), float(v >> 1), 0.25f});
  bytes.text("\nLINES 1 3\n").add_all<int>({2, 0, 1});
  bytes.text("\nPOLYGONS 2 9\n").add_all<int>({4, 0, 1, 3, 2, 3, 0, 1, 3});
  bytes.text("\nCELL_DATA 3\nSCALARS number double 1\nLOOKUP_TABLE default\n");
  bytes.add_all<double>({10, 20, 30});
  bytes.text("\nPOINT_DATA 4\nVECTORS move double\n");
  for (int i = 0; i < 12; ++i) bytes.add(0.1 * i);
  bytes.text("\n");
  return bytes.str();
}

inline std::string binary_vtk_5() {
  Bytes bytes(std::endian::big);
  bytes.text("# vtk DataFile Version 5.1\ntitle\nBINARY\nDATASET UNSTRUCTURED_GRID\n");
  bytes.text("POINTS 4 double\n");
  for (int v = 0; v < 4; ++v) bytes.add_all<double>({double(v & 1), double(v >> 1), 0.25});
  bytes.text("\nCELLS 3 7\nOFFSETS vtktypeint64\n").add_all<std::int64_t>({0, 4, 7});
  bytes.text("\nCONNECTIVITY vtktypeint64\n").add_all<std::int64_t>({0, 1, 2, 3, 0, 1, 3});
  bytes.text("\nCELL_TYPES 2\n").add_all<int>({8, 5});
  bytes.text("\nPOINT_DATA 4\nFIELD FieldData 1\nheat%20flow 2 4 float\n");
  for (int i = 0; i < 8; ++i) bytes.add(0.5f * static_cast<float>(i));
  bytes.text("\nMETADATA\nINFORMATION 0\n\n");
  return bytes.str();
}

inline const char* text_vtu() {
  return R"(<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
  <UnstructuredGrid>
    <Piece NumberOfPoints="4" NumberOfCells="3">
      <PointData><DataArray type="Float64" Name="u" format="ascii">1 2 3 4.5</DataArray></PointData>
      <CellData><DataArray type="Int32" Name="id" format="ascii">7 8 9</DataArray></CellData>
      <Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
        0 0 0.25 1 0 0.25 0 1 0.25 1 1 0.1</DataArray></Points>
      <Cells>
        <DataArray type="Int64" Name="connectivity" format="ascii">0 1 0 1 3 2 0 1 3</DataArray>
        <DataArray type="Int64" Name="offsets" format="ascii">2 6 9</DataArray>
        <DataArray type="UInt8" Name="types" format="ascii">3 9 5</DataArray>
      </Cells>
    </Piece>
  </UnstructuredGrid>
</VTKFile>
)";
}

inline const char* text_vtp() {
  return R"(<?xml version="1.0"?>
<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian">
  <PolyData>
    <Piece NumberOfPoints="4" NumberOfVerts="1" NumberOfLines="0" NumberOfStrips="1"
           NumberOfPolys="1">
      <CellData Scalars="id"><DataArray type="Int32" Name="id" format="ascii">7 8 9</DataArray>
      </CellData>
      <Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">
        0 0 0.25 1 0 0.25 0 1 0.25 1 1 0.5</DataArray></Points>
      <Verts>
        <DataArray type="Int32" Name="connectivity" format="ascii">0</DataArray>
        <DataArray type="Int32" Name="offsets" format="ascii">1</DataArray>
      </Verts>
      <Strips>
        <DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 3</DataArray>
        <DataArray type="Int32" Name="offsets" format="ascii">4</DataArray>
      </Strips>
      <Polys>
        <DataArray type="Int32" Name="connectivity" format="ascii">0 1 3 2</DataArray>
        <DataArray type="Int32" Name="offsets" format="ascii">4</DataArray>
      </Polys>
    </Piece>
  </PolyData>
</VTKFile>
)";
}

inline const std::vector<SampleFile>& sample_files() {
  static const std::vector<SampleFile> samples = [] {
    std::vector<SampleFile> list = {
        {"obj", "a.obj",
         "# comment\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 .5\nf 1/1 2/2 3/3 4/4\n"
         "f -4//1 -3//1 -2//1\n"},
        {"off_text", "a.off",
         "COFF # colours\n4 2 0\n0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n"
         "1 1 0 1 0 0 1\n0 1 0 1 0 0 1\n4 0 1 2 3 255 0 0\n3 0 1 2\n"},
        {"off_binary", "a.off", binary_off()},
        {"ply_text", "a.ply",
         ply_header("ascii") + "0 0 0 0\n1 0 0 50\n0 1 0 100\n1 1 0 150\n"
                               "4 0 1 3 2 1.5\n3 0 1 3 2.5\n"},
        {"ply_little", "a.ply", binary_ply(std::endian::little)},
        {"ply_big", "a.ply", binary_ply(std::endian::big)},
        {"stl_text", "a.stl",
         "solid cube\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
         "vertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n"
         "facet normal 0 0 1\nouter loop\nvertex 0 0 -0\nvertex 1 1 0\n"
         "vertex 0 1 0\nendloop\nendfacet\nendsolid cube\n"},
        {"stl_binary", "a.stl", binary_stl()},
        {"vtk_text", "a.vtk",
         "# vtk DataFile Version 4.2\ntitle\nASCII\nDATASET POLYDATA\n"
         "POINTS 4 double\n0 0 0 1 0 0 1 1 0\n0 1 0\n"
         "POLYGONS 2 9\n4 0 1 2 3\n3 0 1 2\n"
         "POINT_DATA 4\nSCALARS u double\nLOOKUP_TABLE default\n1 2 3 4\n"
         "CELL_DATA 2\nFIELD FieldData 1\nw 2 2 float\n1 2 3 4\n"},
        {"vtk_binary", "a.vtk", binary_vtk()},
        {"vtk_binary_5", "a.vtk", binary_vtk_5()},
        {"vtp_text", "a.vtp", text_vtp()},
        {"vtu_text", "a.vtu", text_vtu()},
    };
    const TemporaryFolder folder;
    for (const char* extension : {"vtp", "vtu"}) {
      const auto path = folder / (std::string("a.") + extension);
      write_surface(path, awkward_mesh(), awkward_fields());
      list.push_back(
          {std::string(extension) + "_appended", std::string("a.") + extension, read_bytes(path)});
    }
    return list;
  }();
  return samples;
}

}  // namespace carat::test
