#pragma once
// Faces as a reader meets them, one corner after the other.

#include <cstdint>
#include <string_view>
#include <utility>

#include "carat/mesh/polygon_mesh.h"

namespace carat::detail {

class FaceCollector {
 public:
  void reserve(std::int64_t n_faces) {
    faces_.offsets.reserve(static_cast<std::size_t>(n_faces) + 1);
  }
  Index size() const { return faces_.n_rows(); }

  /// \throws InvalidMesh  the number does not fit an Index
  void add_corner(std::int64_t vertex);
  /// \throws InvalidMesh  2^31 corners
  void end_face();
  /// Ends a face that began at this position of a text, so that an error can name its line.
  void end_face(std::size_t position) {
    end_face();
    positions_.push_back(position);
  }
  /// Position in the text of a face.
  std::size_t position(Index face) const { return positions_[static_cast<std::size_t>(face)]; }
  const Csr& faces() const { return faces_; }
  /// The faces alone; leaves the collector empty.
  Csr take() { return std::exchange(faces_, {}); }

  /// The mesh of these faces; leaves the collector empty.
  /// \param text  what the positions refer to
  /// \throws InvalidMesh  see PolygonMesh; with the line of the face where positions are known
  PolygonMesh build(Points points, std::string_view text = {});

 private:
  Csr faces_;
  Array<std::size_t> positions_;
};

}  // namespace carat::detail
