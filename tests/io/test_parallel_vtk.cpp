#include "carat/base/error.h"
#include "carat/io/parallel_vtk.h"
#include "io_support.h"

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

}  // namespace
}  // namespace carat::test
