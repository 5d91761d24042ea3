#include "cli/figures.h"

#include <filesystem>
#include <fstream>
#include <utility>
#include <vector>

#include "carat/base/atomic_file.h"
#include "carat/base/error.h"
#include "cli/figure_data.h"
#include "cli/figure_drawing.h"

namespace carat::cli {
namespace {

void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) throw IoError(path.string() + ": cannot be written; is the disk full?");
  });
}

}  // namespace

void write_figures(const Json& experiment, const std::string& directory,
                   const std::vector<ViewItem>& surfaces) {
  std::vector<std::pair<std::string, Picture>> pictures;
  for (const Figure& figure : read_figures(experiment, surfaces))
    pictures.emplace_back(figure.id, draw_figure(figure));
  for (const auto& [id, picture] : pictures) {
    write_bytes(std::filesystem::path(directory) / (id + ".svg"), picture.svg);
    write_bytes(std::filesystem::path(directory) / (id + ".png"), picture.png);
  }
}

}  // namespace carat::cli
