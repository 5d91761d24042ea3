#include "carat/io/face_collector.h"

#include <limits>
#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/io/scanner.h"

namespace carat::detail {
namespace {
constexpr std::int64_t kIndexLimit = std::numeric_limits<Index>::max();
}

void FaceCollector::add_corner(std::int64_t vertex) {
  if (vertex < 0 || vertex > kIndexLimit)
    throw InvalidMesh(
        "face " + std::to_string(size()) + ": vertex " + std::to_string(vertex) + " does not exist",
        {size()});
  faces_.indices.push_back(static_cast<Index>(vertex));
}

void FaceCollector::end_face() {
  if (faces_.indices.size() > static_cast<std::size_t>(kIndexLimit) ||
      faces_.offsets.size() > static_cast<std::size_t>(kIndexLimit))
    throw InvalidMesh("more than " + std::to_string(kIndexLimit) +
                      " faces or face corners; split the mesh");
  faces_.offsets.push_back(static_cast<Index>(faces_.indices.size()));
}

PolygonMesh FaceCollector::build(Points points, std::string_view text) {
  try {
    return PolygonMesh(std::move(points), std::exchange(faces_, {}));
  } catch (const InvalidMesh& error) {
    if (error.elements().empty() || positions_.empty()) throw;
    throw InvalidMesh(line_prefix(text, position(error.elements().front())) + error.what(),
                      error.elements());
  }
}

}  // namespace carat::detail
