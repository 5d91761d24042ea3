#include "carat/base/error.h"
#include "carat/distributed/part_file.h"
#include "carat/distributed/read_parts.h"
#include "io/foam_case.h"
#include "io/piece_files.h"
#include "pieces.h"

namespace carat::test {
namespace {

/// A folder that all processes see; made and removed by the first.
class SharedFolder {
 public:
  SharedFolder() {
    std::array<char, 64> name{};
    if (rank() == 0) {
      folder_ = std::make_unique<TemporaryFolder>();
      std::strncpy(name.data(), folder_->path().c_str(), name.size() - 1);
    }
    MPI_Bcast(name.data(), int(name.size()), MPI_CHAR, 0, MPI_COMM_WORLD);
    path_ = name.data();
  }
  ~SharedFolder() { MPI_Barrier(MPI_COMM_WORLD); }
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::unique_ptr<TemporaryFolder> folder_;
  std::filesystem::path path_;
};

/// Runs work in the first process, while the others wait.
template <class Work>
void first_alone(const Work& work) {
  if (rank() == 0) work();
  MPI_Barrier(MPI_COMM_WORLD);
}

const PolygonMesh& mesh_of(const SurfaceData& data) { return data.mesh; }
const PolyhedralMesh& mesh_of(const VolumeData& data) { return data.mesh; }

/// Pieces with ids: the part of what one file of the whole mesh holds.
template <class Mesh>
void check_vtk_pieces(const Mesh& given, const std::vector<Index>& cut, const PieceForm& form) {
  const SharedFolder folder;
  first_alone([&] {
    write_whole(folder.path(), given);
    write_pieces(folder.path(), given, cut, n_processes(), form);
  });
  const std::string extension = piece_extension(given);
  const auto whole = read_as(folder / ("whole." + extension), given);
  const auto path = folder / ("mesh.p" + extension);
  EXPECT_TRUE(is_in_parts(path));
  const auto data = std::get<PartData<Mesh>>(read_parts(path));
  const auto expected = own_part(mesh_of(whole), cut);
  expect_same(data.part, expected);
  expect_same(data.fields.vertex, select(whole.fields.vertex, expected.numbers.vertices));
  expect_same(data.fields.face, select(whole.fields.face, expected.numbers.elements));
  expect_same(data.fields.cell, select(whole.fields.cell, expected.numbers.elements));
}

TEST(ReadParts, vtk_pieces_are_read_as_the_parts_of_the_whole) {
  for (const FamilyEntry& family : mesh_families()) {
    SCOPED_TRACE(family.name);
    const PolygonMesh mesh = family.generate({.level = 1, .jitter = 0.2});
    for_cuts(mesh, [&](const std::vector<Index>& cut) {
      check_vtk_pieces(mesh, cut, {.element_ids = "face_id"});
    });
  }
  for (const VolumeFamilyEntry& family : volume_families()) {
    SCOPED_TRACE(family.name);
    const PolyhedralMesh mesh = family.generate({.level = 0, .jitter = 0.2});
    for_cuts(mesh, [&](const std::vector<Index>& cut) {
      check_vtk_pieces(mesh, cut, {});
      check_vtk_pieces(mesh, cut, {.ghosts = false});
    });
  }
}

/// What all processes throw, the same in all.
template <class Kind>
std::string failure(const std::filesystem::path& path) {
  std::string message = "nothing is thrown";
  try {
    read_parts(path);
  } catch (const Shared<Kind>& error) {
    message = error.what();
  } catch (const std::exception& error) {
    message = std::string("another error: ") + error.what();
  }
  const auto hash = double(std::hash<std::string>()(message) % 1000003);
  EXPECT_EQ(largest_of_all(hash), hash) << message;
  return message;
}

void expect_says(const std::string& message, const std::string& says) {
  EXPECT_NE(message.find(says), std::string::npos) << message;
}

TEST(ReadParts, processors_of_openfoam_are_read_as_the_parts_of_the_whole) {
  for (const char* family : {"cube-random-hex", "cube-voronoi", "ball-tets"}) {
    SCOPED_TRACE(family);
    const PolyhedralMesh mesh = generate_volume(family, {.level = 0});
    for_cuts(mesh, [&](const std::vector<Index>& cut) {
      const SharedFolder folder;
      const FoamCase form(FoamForm::Binary64);
      first_alone([&] { form.write(folder / "whole", mesh); });
      const VolumeData whole = read_volume(folder / "whole");
      first_alone([&] {
        form.write_divided(folder / "case", whole.mesh, whole.patches, cut, n_processes());
        form.write_divided(folder / "bare", whole.mesh, whole.patches, cut, n_processes(), false);
      });
      EXPECT_TRUE(is_in_parts(folder / "case"));
      EXPECT_FALSE(is_in_parts(folder / "whole"));
      const auto data = std::get<PartData<PolyhedralMesh>>(read_parts(folder / "case"));
      PartData<PolyhedralMesh> expected;
      expected.part = own_part(whole.mesh, cut);
      expected.patches = select(whole.patches, expected.part.numbers);
      expect_same(data, expected);
      // Without numbers it is the same mesh, numbered otherwise.
      const auto bare = std::get<PartData<PolyhedralMesh>>(read_parts(folder / "bare"));
      EXPECT_EQ(bare.part.numbers.n_vertices, mesh.n_vertices());
      EXPECT_EQ(bare.part.numbers.n_components, 1);
      EXPECT_EQ(bare.part.mesh.n_cells(), data.part.mesh.n_cells());
      EXPECT_EQ(bare.part.mesh.n_faces(), data.part.mesh.n_faces());
      ASSERT_EQ(bare.patches.size(), data.patches.size());
      for (std::size_t k = 0; k < bare.patches.size(); ++k)
        EXPECT_EQ(bare.patches[k].faces.size(), data.patches[k].faces.size());
    });
  }
}

TEST(ReadParts, a_processor_of_openfoam_that_is_damaged_is_an_error_in_all_processes) {
  const SharedFolder folder;
  const FoamCase form(FoamForm::Text);
  const std::string last = "processor" + std::to_string(n_processes() - 1);
  first_alone([&] {
    const VolumeData whole = read_volume(form.write(folder / "whole", hex_grid(3)));
    form.write_divided(folder / "case", whole.mesh, whole.patches,
                       in_blocks(whole.mesh.n_cells(), n_processes()), n_processes());
    const auto faces = folder / "case" / last / "constant" / "polyMesh" / "faces";
    write_bytes(faces, read_bytes(faces).substr(0, 700));
  });
  expect_says(failure<IoError>(folder / "case"), last);
}

template <class Mesh>
void check_part_file(const Mesh& mesh) {
  for_cuts(mesh, [&](const std::vector<Index>& cut) {
    const SharedFolder folder;
    first_alone([&] {
      write_part_file(folder / "mesh.cparts", sample_data(mesh), divide(mesh, n_processes(), cut));
    });
    EXPECT_TRUE(is_in_parts(folder / "mesh.cparts"));
    expect_same(std::get<PartData<Mesh>>(read_parts(folder / "mesh.cparts")),
                expected_part(mesh, cut));
  });
}

TEST(ReadParts, a_part_file_gives_every_process_its_part) {
  check_part_file(generate_mesh("sphere-hexagons", {.level = 1}));
  check_part_file(generate_volume("ball-voronoi", {.level = 0}));
}

TEST(ReadParts, a_damaged_part_is_an_error_in_all_processes) {
  const SharedFolder folder;
  const auto path = folder / "mesh.cparts";
  const PolygonMesh mesh = generate_mesh("plane-quads", {.level = 1});
  const auto write = [&](Index n) {
    write_part_file(path, sample_data(mesh), divide(mesh, n, in_blocks(mesh.n_faces(), n)));
  };
  first_alone([&] {
    write(n_processes());
    std::string bytes = read_bytes(path);
    bytes[bytes.size() - 100] ^= 1;
    write_bytes(path, bytes);
  });
  expect_says(failure<IoError>(path), "part " + std::to_string(n_processes() - 1) + " is damaged");
  first_alone([&] {
    const std::string bytes = read_bytes(path);
    write_bytes(path, std::string_view(bytes).substr(0, bytes.size() - 1));
  });
  expect_says(failure<IoError>(path), "beyond the end");
  first_alone([&] { write(n_processes() + 2); });
  expect_says(failure<InvalidOption>(path), "mpirun -np " + std::to_string(n_processes() + 2));
  expect_says(failure<IoError>(folder / "no.cparts"), "No such file");
}

TEST(ReadParts, another_number_of_parts_is_refused_with_both_remedies) {
  const SharedFolder folder;
  const PolyhedralMesh mesh = hex_grid(3);
  const Index n = n_processes() + 1;
  first_alone([&] { write_pieces(folder.path(), mesh, in_blocks(mesh.n_cells(), n), n); });
  const std::string message = failure<InvalidOption>(folder / "mesh.pvtu");
  expect_says(message, "is in " + std::to_string(n) + " parts");
  expect_says(message, "mpirun -np " + std::to_string(n));
  expect_says(message, "carat partition -n " + std::to_string(n_processes()));
}

TEST(ReadParts, damage_of_one_piece_is_an_error_in_all_processes) {
  const SharedFolder folder;
  const PolyhedralMesh mesh = hex_grid(3);
  const Index n = n_processes();
  const std::string last = "mesh_" + std::to_string(n - 1) + ".vtu";
  std::string good;
  first_alone([&] {
    write_pieces(folder.path(), mesh, in_blocks(mesh.n_cells(), n), n);
    good = read_bytes(folder / last);
    write_bytes(folder / last, good.substr(0, good.size() / 2));
  });
  expect_says(failure<IoError>(folder / "mesh.pvtu"), last);
  first_alone([&] { std::filesystem::remove(folder / last); });
  expect_says(failure<IoError>(folder / "mesh.pvtu"), last);
  // A piece of a surface among those of a volume.
  if (n > 1) {
    first_alone([&] {
      const PolygonMesh square = generate_mesh("plane-quads", {.level = 1});
      write_surface(folder / last, square);
    });
    expect_says(failure<IoError>(folder / "mesh.pvtu"), "its piece is a surface");
  }
  first_alone([&] { std::filesystem::remove(folder / "mesh.pvtu"); });
  expect_says(failure<IoError>(folder / "mesh.pvtu"), "mesh.pvtu");
  expect_says(failure<IoError>(folder / "mesh.ply"), "is no mesh in parts");
}

}  // namespace
}  // namespace carat::test
