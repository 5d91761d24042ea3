#pragma once
// PVTU and PVTP: a small index file that names the VTU or VTP files of the parts of a mesh.

#include <filesystem>
#include <string>
#include <vector>

#include "carat/base/types.h"
#include "carat/io/mesh_piece.h"

namespace carat {

/// Name and number of components of a field that every piece has.
struct FieldShape {
  std::string name;
  Index components = 1;
};

/// Writes the index of pieces that write_surface or write_volume write as .vtu or .vtp. It appears
/// under its name only when it is complete.
/// \param path            .pvtu for pieces .vtu, .pvtp for pieces .vtp
/// \param pieces          paths relative to the folder of the index, one a part, in their order
/// \param vertex_fields   of all pieces, in the order in which they have them
/// \param element_fields  the same for faces or cells
/// \param n_ghost_layers  layers of elements of other parts around a piece's own, marked by the
///                        element field kGhostField
/// \throws IoError  another extension, no piece, or the file cannot be written
void write_parallel_index(const std::filesystem::path& path, const std::vector<std::string>& pieces,
                          const std::vector<FieldShape>& vertex_fields,
                          const std::vector<FieldShape>& element_fields, int n_ghost_layers = 0);

/// The files that an index .pvtu or .pvtp names, one a part.
/// \throws IoError  with the path: no such file, malformed, without a piece
std::vector<std::filesystem::path> parallel_pieces(const std::filesystem::path& path);

/// Reads one piece by itself, without the elements that belong to others. Its numbers in the whole
/// mesh are VTK's global ids (the attribute, or arrays named GlobalNodeIds and GlobalElementIds) or
/// the fields vertex_id, face_id and cell_id of `carat partition`; they are no fields any more.
/// \throws  as read_mesh
AnyMeshPiece read_piece(const std::filesystem::path& path);

/// VTK's name of the field that is 1 on elements of other parts. Written as bytes, as VTK wants it.
inline constexpr const char* kGhostField = "vtkGhostType";

}  // namespace carat
