#include "cli/source_file.h"

#include "carat/base/error.h"
#include "carat/io/load_file.h"
#include "carat/io/scanner.h"

namespace carat::cli {

std::vector<std::vector<GeodesicSource>> read_source_sets(const std::string& path,
                                                          Index n_vertices) {
  std::vector<std::vector<GeodesicSource>> sets;
  try {
    const Array<char> content = detail::load_file(path);
    detail::Scanner scanner({content.data(), content.size()}, {.comment = '#'});
    for (; scanner.to_content(); scanner.skip_line()) {
      std::vector<GeodesicSource>& set = sets.emplace_back();
      while (!scanner.at_line_end()) {
        const std::int64_t vertex = scanner.integer();
        if (vertex < 0 || vertex >= n_vertices)
          scanner.fail("vertex " + std::to_string(vertex) +
                       " does not exist; the mesh has vertices 0 to " +
                       std::to_string(n_vertices - 1));
        set.push_back({static_cast<Index>(vertex)});
      }
    }
  } catch (const IoError& error) {
    throw IoError(path + ": " + error.what());
  }
  if (sets.empty()) throw IoError(path + ": lists no source vertices; give one a line");
  return sets;
}

}  // namespace carat::cli
