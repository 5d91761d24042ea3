#pragma once
// OpenFOAM meshes as OpenFOAM writes them.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "io_support.h"

namespace carat::test {

enum class FoamForm { Text, Binary32, Binary64, BigEndian, SinglePrecision };

/// The files of a folder polyMesh, written as OpenFOAM does it.
class FoamCase {
 public:
  explicit FoamCase(FoamForm form) : form_(form) {}

  std::map<std::string, std::string> files(const PolyhedralMesh& mesh) const {
    std::vector<std::int64_t> order, owner, neighbour;
    for (const bool boundary : {false, true})
      for (Index f = 0; f < mesh.n_faces(); ++f)
        if (mesh.face_cells()[static_cast<std::size_t>(f)].boundary() == boundary)
          order.push_back(f);
    std::int64_t n_inner = 0;
    std::vector<std::vector<std::int64_t>> faces;
    for (const std::int64_t f : order) {
      const FaceCells cells = mesh.face_cells()[static_cast<std::size_t>(f)];
      const auto face = mesh.face(static_cast<Index>(f));
      faces.emplace_back(face.begin(), face.end());
      if (cells.below < 0) std::reverse(faces.back().begin(), faces.back().end());
      owner.push_back(cells.below < 0 ? cells.above : cells.below);
      if (!cells.boundary()) neighbour.push_back(cells.above);
      n_inner += cells.boundary() ? 0 : 1;
    }
    const auto n_outer = static_cast<std::int64_t>(faces.size()) - n_inner;
    return {{"points", header("vectorField", "points") + points(mesh.points()) + footer()},
            {"faces", header(binary() ? "faceCompactList" : "faceList", "faces") +
                          face_list(faces) + footer()},
            {"owner", header("labelList", "owner") + labels(owner) + footer()},
            {"neighbour", header("labelList", "neighbour") + labels(neighbour) + footer()},
            {"boundary", header("polyBoundaryMesh", "boundary") + boundary(n_inner, n_outer)}};
  }

  std::filesystem::path write(const std::filesystem::path& folder,
                              const PolyhedralMesh& mesh) const {
    std::filesystem::create_directories(folder / "constant" / "polyMesh");
    for (const auto& [name, content] : files(mesh))
      write_bytes(folder / "constant" / "polyMesh" / name, content);
    return folder;
  }

  bool binary() const { return form_ != FoamForm::Text; }

 private:
  bool long_labels() const { return form_ == FoamForm::Binary64; }

  std::string header(const std::string& type, const std::string& object) const {
    std::string text =
        "/*------------------------*- C++ -*------------------------*\\\n"
        "| =========   | https://example.org (a FoamFile { of words } here) |\n"
        "\\*---------------------------------------------------------*/\n"
        "FoamFile\n{\n    version     2.0;\n    format      ";
    text += binary() ? "binary;\n" : "ascii;\n";
    text += "    class       " + type + ";\n";
    if (binary())
      text += std::string("    arch        \"") + (form_ == FoamForm::BigEndian ? "MSB" : "LSB") +
              ";label=" + (long_labels() ? "64" : "32") +
              ";scalar=" + (form_ == FoamForm::SinglePrecision ? "32" : "64") + "\";\n";
    return text + "    note        \"nCells:2\";\n    location    \"constant/polyMesh\";\n" +
           "    object      " + object + ";\n}\n// * * * * * * //\n\n\n";
  }
  static std::string footer() { return "\n\n\n// ******** //\n"; }

  Bytes bytes() const {
    return Bytes(form_ == FoamForm::BigEndian ? std::endian::big : std::endian::little);
  }

  std::string labels(const std::vector<std::int64_t>& values) const {
    std::string text = std::to_string(values.size()) + "\n(";
    if (!binary()) {
      for (const std::int64_t value : values) text.append("\n").append(std::to_string(value));
      return text + "\n)";
    }
    Bytes raw = bytes();
    for (const std::int64_t value : values)
      if (long_labels()) {
        raw.add(value);
      } else {
        raw.add(static_cast<std::int32_t>(value));
      }
    return text + raw.str() + ")";
  }

  std::string face_list(const std::vector<std::vector<std::int64_t>>& faces) const {
    if (binary()) {
      std::vector<std::int64_t> offsets{0}, all;
      for (const auto& face : faces) {
        all.insert(all.end(), face.begin(), face.end());
        offsets.push_back(static_cast<std::int64_t>(all.size()));
      }
      return labels(offsets) + "\n" + labels(all);
    }
    std::string text = std::to_string(faces.size()) + "\n(\n";
    for (const auto& face : faces) {
      text += std::to_string(face.size()) + "(";
      for (std::size_t k = 0; k < face.size(); ++k)
        text.append(k > 0 ? " " : "").append(std::to_string(face[k]));
      text += ")\n";
    }
    return text + ")";
  }

  std::string points(const Points& points) const {
    std::string text = std::to_string(points.rows()) + "\n(";
    Bytes raw = bytes();
    char number[32];
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
      if (!binary()) text += "\n(";
      for (int k = 0; k < 3; ++k) {
        std::snprintf(number, sizeof number, k < 2 ? "%.17g " : "%.17g)", points(v, k));
        if (!binary()) text += number;
        if (form_ == FoamForm::SinglePrecision) {
          raw.add(static_cast<float>(points(v, k)));
        } else {
          raw.add(points(v, k));
        }
      }
    }
    return text + (binary() ? raw.str() : "\n") + ")";
  }

  static std::string boundary(std::int64_t start, std::int64_t n) {
    return "2\n(\n    inlet\n    {\n        type            patch;\n        nFaces          1;\n"
           "        startFace       " +
           std::to_string(start) +
           ";\n    }\n    \"side walls\"\n    {\n"
           "        type            wall;\n        inGroups        1(wall);\n"
           "        transform { kind none; }\n        nFaces          " +
           std::to_string(n - 1) + ";\n        startFace       " + std::to_string(start + 1) +
           "; // the rest\n    }\n)\n";
  }

  FoamForm form_;
};

}  // namespace carat::test
