#pragma once
// One self-contained interactive HTML page of meshes and their fields.

#include <filesystem>
#include <string>
#include <vector>

#include "carat/io/mesh_file.h"

namespace carat {

/// One mesh of a page, a surface or a volume.
struct ViewItem {
  std::string title;
  MeshData data;
};

/// Writes one HTML file that needs no network and no server.
/// \param title  shown as the page's heading
/// \throws InvalidOption  no item, or a field that does not fit its mesh
/// \throws IoError        the file cannot be written (an existing one is then untouched)
void write_html_view(const std::filesystem::path& path, const std::vector<ViewItem>& items,
                     const std::string& title = "carat");

/// What such a page holds beside its program, for pages that show it in a frame: HTML elements
/// that stand in the viewer's template for its data.
/// \throws InvalidOption  as above
std::string html_view_data(const std::vector<ViewItem>& items, const std::string& title);

}  // namespace carat
