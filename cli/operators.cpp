// carat operators: the matrices of a mesh as files.

#include "cli/operators.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>
#include <system_error>

#include "carat/base/error.h"
#include "carat/io/matrix_market.h"
#include "cli/command.h"
#include "cli/files.h"

namespace carat::cli {
namespace {

namespace fs = std::filesystem;

std::string sign_convention(const std::string& measure, const Discretization& d,
                            const OperatorClaims& claims) {
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
  const auto write = [&](const MatrixFile& file, const SparseMatrix& matrix) {
    files.push_back(file.name);
    write_matrix_market(folder / file.name, matrix,
                        file.symmetric ? MatrixSymmetry::Symmetric : MatrixSymmetry::General,
                        file.comment);
  };
  write(stiffness_file(d), d.stiffness);
  write(mass_file(d, measure), d.mass);
  if (d.gradient_dimension > 0) {
    write(gradient_file(d), d.gradient);
    write(divergence_file(d), d.divergence());
  }
  if (d.is_one_form()) write(inner_product_file(d), d.one_forms.inner_product);
  if (d.extra.size() > 0) {
    files.emplace_back("unknowns.csv");
    write_text(folder / files.back(), describe_unknowns(d));
  }
  return files;
}

/// Whether the samples are those of the sides of faces.
bool has_samples_at_sides(const PolygonMesh&, const Discretization&) { return false; }
bool has_samples_at_sides(const PolyhedralMesh& mesh, const Discretization& d) {
  return d.n_samples() == mesh.face_mesh().n_corners();
}

template <class Mesh>
void write_operators(Session& session, const OperatorsArguments& options, const Mesh& mesh) {
  const TemporaryFolder folder(options.output);
  const Discretization discretization =
      discretize(session, mesh, options.discretization, DiscretizationParts::Gradient);
  const std::string measure = words(mesh).measure;
  std::vector<std::string> files = session.phase(
      "write", [&] { return write_matrices(folder.path(), discretization, measure); });
  publish_operators(session, options, folder, std::move(files), discretization,
                    claims_of(mesh, discretization.name), measure,
                    has_samples_at_sides(mesh, discretization));
}

void run(Session& session, const OperatorsArguments& options) {
  if (session.engine() != nullptr) {
    session.engine()->operators(session, options);
    return;
  }
  const MeshData data = read_input(session, options.input);
  std::visit([&](const auto& held) { write_operators(session, options, held.mesh); }, data);
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<OperatorsArguments>();
  app.add_option("MESH", options->input, "The mesh")->required();
  app.add_option("-o,--output", options->output, "Folder for the files; created if missing")
      ->required();
  declare_engine_option(app);
  declare_operator_options(app, options->discretization, std::nullopt);
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

TemporaryFolder::TemporaryFolder(const fs::path& target) : target_(target) {
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

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void TemporaryFolder::publish(const std::vector<std::string>& files) const {
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

MatrixFile stiffness_file(const Discretization& d) {
  return {"stiffness.mtx", d.name + " stiffness S, positive semidefinite; laplacian L = -S", true};
}

MatrixFile mass_file(const Discretization& d, const std::string& measure) {
  return {"mass.mtx", d.name + " mass M, sum = " + measure, true};
}

MatrixFile gradient_file(const Discretization& d) {
  return {"gradient.mtx", d.name + " gradient G", false};
}

MatrixFile divergence_file(const Discretization& d) {
  return {"divergence.mtx", d.name + " divergence D = -G^T M_s, integrated", false};
}

MatrixFile inner_product_file(const Discretization& d) {
  return {"inner_product.mtx", d.name + " inner product M_s of one-forms", true};
}

void publish_operators(Session& session, const OperatorsArguments& arguments,
                       const TemporaryFolder& folder, std::vector<std::string> files,
                       const Discretization& d, const OperatorClaims& claims,
                       const std::string& measure, bool faces_and_sides) {
  const bool has_gradient = d.gradient_dimension > 0;
  if (!has_gradient) session.note("this operator has no gradient: stiffness and mass only");
  files.emplace_back("operators.json");
  Json& report = session.report();
  report["sign_convention"] = sign_convention(measure, d, claims);
  if (has_gradient)
    report["frame_convention"] = frame_convention(
        d.gradient_dimension,
        faces_and_sides
            ? "; samples are diamonds, ordered by the faces of the mesh and then by the "
              "sides of the face"
            : "");
  report["output"] = arguments.output;
  report["files"] = files;
  write_text(folder.path() / files.back(), session.snapshot().dump(2) + "\n");
  folder.publish(files);
  session.say("written: " + arguments.output + "/ with stiffness S" +
              (claims.semidefinite ? " (positive semidefinite)" : "") + ", mass M" +
              (has_gradient ? ", gradient G, divergence D" : "") +
              (has_gradient && claims.divergence_of_gradient ? ": -S = D G" : ""));
}

const OperatorClaims& claims_of(const PolygonMesh&, const std::string& name) {
  return surface_operator(name).claims;
}

const OperatorClaims& claims_of(const PolyhedralMesh&, const std::string& name) {
  return volume_operator(name).claims;
}

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
