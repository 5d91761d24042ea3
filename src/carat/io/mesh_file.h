#pragma once
// Reading and writing surface and volume meshes with their fields.

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "carat/mesh/fields.h"
#include "carat/mesh/polygon_mesh.h"
#include "carat/mesh/polyhedral_mesh.h"

namespace carat {

/// A mesh with the fields that came with it.
struct SurfaceData {
  PolygonMesh mesh;
  MeshFields fields;
};

/// A named set of boundary faces, as simulation codes have them.
struct BoundaryPatch {
  std::string name;
  std::string type;          ///< e.g. "wall"; may be empty
  std::vector<Index> faces;  ///< ascending
};

/// A volume mesh with what came with it.
struct VolumeData {
  PolyhedralMesh mesh;
  MeshFields fields;
  std::vector<BoundaryPatch> patches{};
};

/// What a file can hold.
using MeshData = std::variant<SurfaceData, VolumeData>;

/// One supported format, e.g. {"ply", "Stanford PLY", {".ply"}, true, true, true}.
struct FileFormat {
  std::string name;
  std::string title;
  std::vector<std::string> extensions;  ///< lower case, with the dot
  bool reads = false, writes = false;
  bool fields = false;  ///< carries named vertex and face fields, of volumes vertex and cell ones
  bool reads_volumes = false, writes_volumes = false;
  bool surfaces = true;         ///< can hold surface meshes at all: what reads and writes speak of
  bool writes_patches = false;  ///< keeps the boundary patches of volumes
};

/// All formats, in the order of the table in the documentation.
const std::vector<FileFormat>& file_formats();

/// Reads a surface mesh. The format is found from the content where that is telling, else from
/// the extension. Vertices and faces keep the file's order and number; nothing is triangulated;
/// STL corners are welded where their coordinates are exactly equal. Of VTK files the 2-D cells
/// are kept, triangle strips as their triangles; vertices and lines are passed over.
/// \throws IoError      missing, unreadable, truncated or malformed file, unknown format, a volume
///                      mesh; the message names the path and the line or element
/// \throws InvalidMesh  what the file holds is no mesh (see PolygonMesh); message with the path
SurfaceData read_surface(const std::filesystem::path& path);

/// Reads a volume mesh: OVM, VTU, legacy VTK, Medit, Gmsh, or an OpenFOAM mesh, which is named by
/// its case folder, the folder polyMesh, a file in that, or a file *.foam in the case. Vertices and
/// cells keep the file's order and number, faces where the file has them; of files with cells of
/// several dimensions the 3-D ones are kept.
/// \throws  as read_surface; a file without 3-D cells
VolumeData read_volume(const std::filesystem::path& path);

/// Reads what the file holds: a volume if it has 3-D cells, else a surface.
MeshData read_mesh(const std::filesystem::path& path);

/// Writes a surface mesh, with the fields where the format has them (OBJ, OFF: the mesh alone).
/// Every double comes back bit by bit. Characters that a field's name cannot have in the format
/// (blanks in PLY, <>&"' in VTP and VTU, " in OVM) become '_'.
/// The format is found from the extension. The file appears under its name only when it is
/// complete: on failure an existing one is untouched.
/// \throws IoError        unknown extension, or the file cannot be written
/// \throws InvalidOption  a field whose number of rows does not fit the mesh, without a name, or
///                        with the name of another one
void write_surface(const std::filesystem::path& path, const PolygonMesh& mesh,
                   const MeshFields& fields = {});

/// Writes a volume mesh with its fields of vertices and cells. Otherwise as write_surface.
/// VTU: tetrahedra, hexahedra, wedges and pyramids as such, all other cells as polyhedra; without
/// the patches. OVM: patches as face properties of type bool.
/// \throws  as write_surface; InvalidOption also for a patch with a face that does not exist
void write_volume(const std::filesystem::path& path, const PolyhedralMesh& mesh,
                  const MeshFields& fields = {}, const std::vector<BoundaryPatch>& patches = {});

}  // namespace carat
