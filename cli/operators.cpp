// carat operators: the matrices of a mesh as files.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <system_error>

#include "carat/base/error.h"
#include "carat/io/matrix_market.h"
#include "cli/command.h"
#include "cli/files.h"
#include "cli/operator_options.h"

namespace carat::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string input, output;
  OperatorOptions discretization;
};

std::string sign_convention(const KindWords& kind, const Discretization& d,
                            const OperatorClaims& claims) {
  const std::string measure = kind.measure;
  std::string text =
      claims.semidefinite
          ? "stiffness S is symmetric positive semidefinite and integrated; laplacian L = -S is "
            "negative semidefinite, pointwise M^-1 L"
          : "stiffness S is symmetric and integrated, positive semidefinite on Delaunay meshes; "
            "laplacian L = -S, pointwise M^-1 L";
  if (d.is_one_form())
    text += "; divergence D = -G^T M_s, M_s the inner product of one-forms";
  else if (d.gradient_dimension > 0)
    text += "; divergence D = -G^T M_s, M_s holding each sample's " + measure + " once a component";
  if (d.gradient_dimension > 0)
    text += claims.divergence_of_gradient ? "; L = D G"
                                          : "; L is D G plus the operator's stabilising term";
  return text + "; mass M sums to the " + measure;
}

std::string frame_convention(Index dimension, const std::string& order) {
  if (dimension == 1)
    return "row c of the gradient is the difference along side c, counted from 0 through the faces "
           "in their order: value at the side's end minus value at its start";
  const std::string rows = "row " + std::to_string(dimension) +
                           " s + k of the gradient is component k of sample s, counted from 0";
  if (dimension != 2) return rows + "; components are along x, y, z" + order;
  return rows +
         "; a sample lies about an edge, unfolded flat: component 0 runs along the edge from its "
         "lower to its higher vertex, component 1 points, at right angles to it, into the face "
         "that runs along the edge in that direction";
}

/// A folder for files that are not complete. What is left in it is removed in the end.
class TemporaryFolder {
 public:
  /// Inside `target` if it exists (so that moving the files is a rename), else beside it.
  explicit TemporaryFolder(const fs::path& target) : target_(target) {
    std::error_code failure;
    exists_ = fs::is_directory(target, failure);
    if (!exists_ && fs::exists(target, failure))
      throw IoError(target.string() + ": is no folder; name another one");
    const fs::path parent = exists_                    ? target
                            : target.has_parent_path() ? target.parent_path()
                                                       : fs::path(".");
    if (!fs::is_directory(parent, failure))
      throw IoError(target.string() + ": the folder " + parent.string() +
                    " does not exist; create it first");
    path_ = parent / ((exists_ ? "operators" : target.filename().string()) + ".part" +
                      std::to_string(::getpid()));
    if (!fs::create_directory(path_, failure))
      throw IoError(target.string() + ": cannot be written: " +
                    (failure ? failure.message() : path_.string() + " is in the way; remove it"));
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const fs::path& path() const { return path_; }

  /// Moves everything to the target.
  void publish(const std::vector<std::string>& files) const {
    std::error_code ignored, failure;
    for (const std::string& file : files)
      if (fs::is_directory(target_ / file, ignored))
        throw IoError((target_ / file).string() + ": is a folder; remove it");
    if (exists_) {
      for (const std::string& file : files)
        if (!failure) fs::rename(path_ / file, target_ / file, failure);
    } else {
      fs::rename(path_, target_, failure);
    }
    if (failure) throw IoError(target_.string() + ": cannot be written: " + failure.message());
  }

 private:
  fs::path target_, path_;
  bool exists_ = false;
};

void write_text(const fs::path& path, const std::string& content) {
  std::ofstream out(path);
  out << content;
  out.close();
  if (!out) throw IoError(path.string() + ": cannot be written; is the disk full?");
}

/// What the rows beyond the vertices are, one a line.
std::string describe_unknowns(const Discretization& d) {
  constexpr const char* kSites[] = {"face", "cell", "edge"};
  std::ostringstream out;
  out.precision(17);
  out << "row,site,element,x,y,z\n";
  Index k = 0;
  for (const ExtraUnknowns::Block& block : d.extra.blocks)
    for (const Index element : block.elements) {
      const auto x = d.extra.positions.row(k);
      out << d.n_vertices() + k++ << ',' << kSites[static_cast<std::size_t>(block.site)] << ','
          << element << ',' << x[0] << ',' << x[1] << ',' << x[2] << '\n';
    }
  return out.str();
}

/// Writes the matrices and names their files.
std::vector<std::string> write_matrices(const fs::path& folder, const Discretization& d,
                                        const std::string& measure) {
  std::vector<std::string> files;
  const auto write = [&](const std::string& name, const SparseMatrix& matrix,
                         MatrixSymmetry symmetry, const std::string& comment) {
    files.push_back(name + ".mtx");
    write_matrix_market(folder / files.back(), matrix, symmetry, comment);
  };
  write("stiffness", d.stiffness, MatrixSymmetry::Symmetric,
        d.name + " stiffness S, positive semidefinite; laplacian L = -S");
  write("mass", d.mass, MatrixSymmetry::Symmetric, d.name + " mass M, sum = " + measure);
  if (d.gradient_dimension > 0) {
    write("gradient", d.gradient, MatrixSymmetry::General, d.name + " gradient G");
    write("divergence", d.divergence(), MatrixSymmetry::General,
          d.name + " divergence D = -G^T M_s, integrated");
  }
  if (d.is_one_form())
    write("inner_product", d.one_forms.inner_product, MatrixSymmetry::Symmetric,
          d.name + " inner product M_s of one-forms");
  if (d.extra.size() > 0) {
    files.emplace_back("unknowns.csv");
    write_text(folder / files.back(), describe_unknowns(d));
  }
  return files;
}

/// How the samples of a gradient with components along x, y, z are numbered.
std::string sample_order(const PolygonMesh&, const Discretization&) { return ""; }

std::string sample_order(const PolyhedralMesh& mesh, const Discretization& d) {
  if (d.n_samples() == mesh.face_mesh().n_corners())
    return "; samples are diamonds, ordered by the faces of the mesh and then by the sides of the "
           "face";
  return "";
}

const SurfaceOperator& entry_of(const PolygonMesh&, const std::string& name) {
  return surface_operator(name);
}
const VolumeOperator& entry_of(const PolyhedralMesh&, const std::string& name) {
  return volume_operator(name);
}

template <class Mesh>
void write_operators(Session& session, const Options& options, const Mesh& mesh) {
  const TemporaryFolder folder(options.output);
  const Discretization discretization =
      discretize(session, mesh, options.discretization, DiscretizationParts::Gradient);
  const bool has_gradient = discretization.gradient_dimension > 0;
  const OperatorClaims& claims = entry_of(mesh, discretization.name).claims;
  std::vector<std::string> files = session.phase(
      "write", [&] { return write_matrices(folder.path(), discretization, words(mesh).measure); });
  if (!has_gradient) session.note("this operator has no gradient: stiffness and mass only");

  files.push_back("operators.json");
  Json& report = session.report();
  report["sign_convention"] = sign_convention(words(mesh), discretization, claims);
  if (has_gradient)
    report["frame_convention"] =
        frame_convention(discretization.gradient_dimension, sample_order(mesh, discretization));
  report["output"] = options.output;
  report["files"] = files;
  write_text(folder.path() / files.back(), session.snapshot().dump(2) + "\n");
  folder.publish(files);
  session.say("written: " + options.output + "/ with stiffness S" +
              (claims.semidefinite ? " (positive semidefinite)" : "") + ", mass M" +
              (has_gradient ? ", gradient G, divergence D" : "") +
              (has_gradient && claims.divergence_of_gradient ? ": -S = D G" : ""));
}

void run(Session& session, const Options& options) {
  const MeshData data = read_input(session, options.input);
  std::visit([&](const auto& held) { write_operators(session, options, held.mesh); }, data);
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("MESH", options->input, "The mesh")->required();
  app.add_option("-o,--output", options->output, "Folder for the files; created if missing")
      ->required();
  declare_operator_options(app, options->discretization, std::nullopt);
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

const Command operators_command = {
    "operators",
    "Write stiffness, mass, gradient and divergence as Matrix Market files",
    "Files: stiffness.mtx mass.mtx gradient.mtx divergence.mtx, and operators.json with sizes,\n"
    "conventions and diagnostics. S is positive semidefinite, the laplacian is L = -S.\n"
    "Operators with unknowns beyond the vertices add unknowns.csv; one-forms, inner_product.mtx.\n"
    "Of symmetric matrices the lower triangle is written, as the format has it.",
    "  carat operators bunny.obj -o operators\n"
    "  carat operators ball.vtu --operator bunge --lumped -o operators\n"
    "  carat operators mesh.ply --virtual-point centroid --weights minimum-norm -o study\n",
    false,
    declare};

}  // namespace carat::cli
