#pragma once
// A mesh in parts, written as it is: a file a part, and an index.

#include <filesystem>

#include "carat/mesh/fields.h"
#include "carat/mesh/mesh_part.h"

namespace carat {

/// Whether a path names an index: .pvtu or .pvtp.
bool is_parallel_index(const std::filesystem::path& path);

/// Collective. Every process writes its own elements, the first one the index: u.pvtu names
/// u_0.vtu, u_1.vtu, ... beside it. Besides the fields these have vertex_id and face_id or cell_id,
/// the numbers in the whole mesh, and part. All are first written under other names: unless every
/// process succeeds in that, nothing appears and what was there stays.
/// \param path    .pvtu, of surfaces also .pvtp
/// \param fields  at the part's vertices and elements, those of the halo too, which are not written
/// \throws InvalidOption  Shared
/// \throws IoError  likewise
void write_parts(const std::filesystem::path& path, const MeshPart<PolygonMesh>& part,
                 const MeshFields& fields);
void write_parts(const std::filesystem::path& path, const MeshPart<PolyhedralMesh>& part,
                 const MeshFields& fields);

}  // namespace carat
