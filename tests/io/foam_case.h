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

  /// The case of a mesh that such files gave, divided over processors as decomposePar does it.
  /// \param patches  of the whole mesh, which hold all of its boundary
  std::filesystem::path write_divided(const std::filesystem::path& folder,
                                      const PolyhedralMesh& mesh,
                                      const std::vector<BoundaryPatch>& patches,
                                      const std::vector<Index>& cell_part, Index n_parts,
                                      bool addressing = true) const {
    for (Index p = 0; p < n_parts; ++p) {
      const auto files = folder / ("processor" + std::to_string(p)) / "constant" / "polyMesh";
      std::filesystem::create_directories(files);
      for (const auto& [name, content] : processor_files(mesh, patches, cell_part, p, n_parts))
        if (addressing || name.find("ProcAddressing") == name.npos)
          write_bytes(files / name, content);
    }
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

  using Labels = std::vector<std::int64_t>;

  std::map<std::string, std::string> processor_files(const PolyhedralMesh& mesh,
                                                     const std::vector<BoundaryPatch>& patches,
                                                     const std::vector<Index>& cell_part, Index p,
                                                     Index n_parts) const {
    std::map<Index, std::int64_t> cell_place, point_place;
    Labels cells, points_here, face_ids, owner, neighbour, patch_ids;
    for (Index c = 0; c < mesh.n_cells(); ++c)
      if (cell_part[std::size_t(c)] == p) {
        cell_place[c] = static_cast<std::int64_t>(cells.size());
        cells.push_back(c);
      }
    const auto own = [&](Index c) { return c >= 0 && cell_part[std::size_t(c)] == p; };
    const auto sides = [&](Index f) { return mesh.face_cells()[std::size_t(f)]; };
    std::vector<Labels> faces;
    // A face points out of its owner: what came from files does so in the whole mesh.
    const auto add = [&](Index f, bool turned) {
      Labels face(mesh.face(f).begin(), mesh.face(f).end());
      if (turned) std::reverse(face.begin() + 1, face.end());
      faces.push_back(face);
      face_ids.push_back(turned ? -(f + 1) : f + 1);
      owner.push_back(cell_place[turned ? sides(f).above : sides(f).below]);
    };
    for (Index f = 0; f < mesh.n_faces(); ++f)
      if (own(sides(f).below) && own(sides(f).above)) {
        add(f, false);
        neighbour.push_back(cell_place[sides(f).above]);
      }
    std::string list;
    std::size_t start = faces.size(), n_patches = 0;
    const auto end_patch = [&](const std::string& name, const std::string& rest, int id) {
      list += "    \"" + name + "\"\n    {\n        " + rest + "\n        nFaces " +
              std::to_string(faces.size() - start) + ";\n        startFace " +
              std::to_string(start) + ";\n    }\n";
      start = faces.size();
      patch_ids.push_back(id);
      ++n_patches;
    };
    for (std::size_t k = 0; k < patches.size(); ++k) {
      for (const Index f : patches[k].faces)
        if (own(std::max(sides(f).below, sides(f).above))) add(f, false);
      end_patch(patches[k].name, "type " + patches[k].type + ";", int(k));
    }
    for (Index other = 0; other < n_parts; ++other) {
      const std::size_t before = faces.size();
      for (Index f = 0; f < mesh.n_faces(); ++f) {
        const FaceCells both = sides(f);
        if (other == p || both.below < 0 || both.above < 0 || own(both.below) == own(both.above))
          continue;
        const bool turned = own(both.above);
        if (cell_part[std::size_t(turned ? both.below : both.above)] == other) add(f, turned);
      }
      const std::string names =
          std::to_string(p) + ";\n        neighbProcNo " + std::to_string(other);
      if (faces.size() > before)
        end_patch(
            "procBoundary" + std::to_string(p) + "to" + std::to_string(other),
            "type processor;\n        inGroups 1(processor);\n        myProcNo " + names + ";", -1);
    }
    for (Labels& face : faces)
      for (std::int64_t& v : face) {
        const auto [at, added] = point_place.emplace(static_cast<Index>(v),
                                                     static_cast<std::int64_t>(points_here.size()));
        if (added) points_here.push_back(v);
        v = at->second;
      }
    Points places(static_cast<Eigen::Index>(points_here.size()), 3);
    for (std::size_t v = 0; v < points_here.size(); ++v)
      places.row(static_cast<Eigen::Index>(v)) =
          mesh.points().row(static_cast<Eigen::Index>(points_here[v]));
    const auto label_file = [&](const char* name, const Labels& values) {
      return header("labelList", name) + labels(values) + footer();
    };
    return {{"points", header("vectorField", "points") + points(places) + footer()},
            {"faces", header(binary() ? "faceCompactList" : "faceList", "faces") +
                          face_list(faces) + footer()},
            {"owner", label_file("owner", owner)},
            {"neighbour", label_file("neighbour", neighbour)},
            {"boundary", header("polyBoundaryMesh", "boundary") + std::to_string(n_patches) +
                             "\n(\n" + list + ")\n"},
            {"pointProcAddressing", label_file("pointProcAddressing", points_here)},
            {"faceProcAddressing", label_file("faceProcAddressing", face_ids)},
            {"cellProcAddressing", label_file("cellProcAddressing", cells)},
            {"boundaryProcAddressing", label_file("boundaryProcAddressing", patch_ids)}};
  }

  FoamForm form_;
};

}  // namespace carat::test
