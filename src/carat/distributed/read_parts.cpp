#include "carat/distributed/read_parts.h"

#include <string>
#include <utility>
#include <vector>

#include "carat/base/error.h"
#include "carat/distributed/exchange.h"
#include "carat/distributed/mesh_pieces.h"
#include "carat/distributed/part_file.h"
#include "carat/io/openfoam.h"
#include "carat/io/parallel_vtk.h"

namespace carat {
namespace {

namespace fs = std::filesystem;

bool is_parallel_vtk(const fs::path& path) {
  return path.extension() == ".pvtu" || path.extension() == ".pvtp";
}

/// \throws InvalidOption
void check_number_of_parts(const fs::path& path, std::size_t n_parts) {
  const auto n = static_cast<std::size_t>(n_processes());
  if (n_parts == n) return;
  throw InvalidOption(path.string() + ": is in " + std::to_string(n_parts) + " parts, but " +
                      std::to_string(n) + (n == 1 ? " process reads" : " processes read") +
                      " it; start as many (mpirun -np " + std::to_string(n_parts) +
                      "), or divide the mesh anew (carat partition -n " + std::to_string(n) + ")");
}

/// A piece without elements says nothing of its kind.
MeshPiece<PolyhedralMesh> as_volume(MeshPiece<PolygonMesh> empty) {
  MeshPiece<PolyhedralMesh> piece;
  piece.mesh = PolyhedralMesh(empty.mesh.points(), {}, {});
  piece.vertex_ids = std::move(empty.vertex_ids);
  piece.fields.vertex = std::move(empty.fields.vertex);
  return piece;
}

/// Collective. Joins pieces of either kind.
AnyPartData join(AnyMeshPiece piece) {
  const auto* const surface = std::get_if<MeshPiece<PolygonMesh>>(&piece);
  const bool has_faces = surface != nullptr && surface->mesh.n_faces() > 0;
  const bool some_volume = most_of_all(surface == nullptr ? 1 : 0) == 1;
  together([&] {
    if (some_volume && has_faces)
      throw IoError("its piece is a surface, but others are volumes; they are not of one mesh");
  });
  if (!some_volume) return join_pieces(std::get<MeshPiece<PolygonMesh>>(std::move(piece)));
  if (surface != nullptr)
    return join_pieces(as_volume(std::get<MeshPiece<PolygonMesh>>(std::move(piece))));
  return join_pieces(std::get<MeshPiece<PolyhedralMesh>>(std::move(piece)));
}

}  // namespace

bool is_in_parts(const fs::path& path) {
  return is_parallel_vtk(path) || path.extension() == ".cparts" || !foam_processors(path).empty();
}

AnyPartData read_parts(const fs::path& path) {
  if (path.extension() == ".cparts") {
    AnyPartData data;
    together([&] {
      check_number_of_parts(path, static_cast<std::size_t>(count_parts(path)));
      data = read_part(path, own_rank());
    });
    return data;
  }
  AnyMeshPiece piece;
  together([&] {
    if (!is_in_parts(path))
      throw IoError(
          path.string() +
          ": is no mesh in parts; divide it first (carat partition MESH -n N -o mesh.cparts)");
    const bool vtk = is_parallel_vtk(path);
    const std::vector<fs::path> files = vtk ? parallel_pieces(path) : foam_processors(path);
    check_number_of_parts(path, files.size());
    const fs::path& own = files[static_cast<std::size_t>(own_rank())];
    piece = vtk ? read_piece(own) : AnyMeshPiece(read_foam_piece(own));
  });
  return join(std::move(piece));
}

}  // namespace carat
