// carat operators over several processes.

#include "cli/operators.h"

#include <memory>

#include "carat/base/error.h"
#include "carat/distributed/matrix_rows.h"
#include "carat/distributed/part_samples.h"
#include "carat/io/matrix_market.h"
#include "cli/petsc/part_engine.h"
#include "cli/petsc/parts.h"

namespace carat::cli {
namespace {

namespace fs = std::filesystem;

/// Where the rows or columns of a part's matrix are in that of the whole mesh; -1: nowhere.
using Places = std::vector<std::int64_t>;

/// Numbers of the gradient's rows.
Places row_places(const Discretization& d, const PartSamples& samples) {
  Places places;
  for (Index s = 0; s < d.n_samples(); ++s)
    for (Eigen::Index row = d.first_row(s); row < d.first_row(s + 1); ++row) {
      const std::int64_t first = samples.first_rows[static_cast<std::size_t>(s)];
      places.push_back(first < 0 ? -1 : first + row - d.first_row(s));
    }
  return places;
}

/// Writes the matrices that the parts add up to, one after the other.
class MatrixWriter {
 public:
  /// \param folder  in the first process
  explicit MatrixWriter(const TemporaryFolder* folder) : folder_(folder) {}

  /// \param n_rows, n_columns  of the whole mesh
  /// \return the number of entries, of symmetric matrices those of both triangles
  std::int64_t write(const MatrixFile& file, const SparseMatrix& part, const Places& rows,
                     std::int64_t n_rows, const Places& columns, std::int64_t n_columns) {
    std::vector<MatrixEntry> entries;
    std::int64_t n_diagonal = 0;
    together([&] {
      for (Index row = 0; row < part.rows(); ++row) {
        const std::int64_t to = rows[static_cast<std::size_t>(row)];
        if (to < 0) continue;
        for (SparseMatrix::InnerIterator entry(part, row); entry; ++entry) {
          const std::int64_t column = columns[static_cast<std::size_t>(entry.col())];
          if (column < 0 || (file.symmetric && column > to)) continue;
          entries.push_back({to, column, entry.value()});
        }
      }
    });
    const MatrixRows matrix(entries, n_rows);
    entries = {};
    files_.push_back(file.name);
    std::int64_t n_entries = matrix.n_entries();
    if (folder_ == nullptr) {
      matrix.visit({});
    } else {
      write_matrix_market(folder_->path() / file.name, n_rows, n_columns, n_entries,
                          file.symmetric ? MatrixSymmetry::Symmetric : MatrixSymmetry::General,
                          file.comment, [&](const PutEntry& put) {
                            matrix.visit([&](const MatrixEntry& entry) {
                              if (entry.row == entry.column) ++n_diagonal;
                              put(entry.row, entry.column, entry.value);
                            });
                          });
    }
    return file.symmetric ? 2 * n_entries - n_diagonal : n_entries;
  }
  const std::vector<std::string>& files() const { return files_; }

 private:
  const TemporaryFolder* folder_;
  std::vector<std::string> files_;
};

template <class Mesh>
void write_operators(Session& session, const OperatorsArguments& arguments,
                     const TemporaryFolder* folder, const PartData<Mesh>& data) {
  const MeshPart<Mesh>& part = data.part;
  const Discretization d =
      discretize(session, part, arguments.discretization, DiscretizationParts::Gradient);
  const std::string measure = words(part.mesh).measure;
  const PartSamples samples = number_samples(part, d);
  const std::int64_t n = part.numbers.n_vertices;
  const Places vertices(part.numbers.vertices.begin(), part.numbers.vertices.end());
  Places rows;
  if (d.gradient_dimension > 0) rows = row_places(d, samples);

  Json& report = session.report();
  MatrixWriter writer(folder);
  session.phase("write", [&] {
    Json& nnz = report["nnz"];
    nnz["stiffness"] = writer.write(stiffness_file(d), d.stiffness, vertices, n, vertices, n);
    nnz["mass"] = writer.write(mass_file(d, measure), d.mass, vertices, n, vertices, n);
    if (d.gradient_dimension > 0) {
      nnz["gradient"] =
          writer.write(gradient_file(d), d.gradient, rows, samples.n_rows, vertices, n);
      SparseMatrix divergence;
      together([&] { divergence = d.divergence(); });
      nnz["divergence"] =
          writer.write(divergence_file(d), divergence, vertices, n, rows, samples.n_rows);
    }
    if (d.is_one_form())
      writer.write(inner_product_file(d), d.one_forms.inner_product, rows, samples.n_rows, rows,
                   samples.n_rows);
  });
  report["sizes"]["samples"] = samples.n_samples;
  report["sizes"]["gradient_dimension"] = d.gradient_dimension;
  constexpr bool kVolume = std::is_same_v<Mesh, PolyhedralMesh>;
  on_first([&] {
    publish_operators(session, arguments, *folder, writer.files(), d, claims_of(part.mesh, d.name),
                      measure, kVolume && !d.options.own_interfaces.empty());
  });
}

}  // namespace

void PartEngine::operators(Session& session, const OperatorsArguments& arguments) const {
  std::unique_ptr<TemporaryFolder> folder;
  on_first([&] { folder = std::make_unique<TemporaryFolder>(arguments.output); });
  const PartInput input = read_part_input(session, arguments.input, "");
  std::visit([&](const auto& data) { write_operators(session, arguments, folder.get(), data); },
             input.data);
  report_memory(session);
}

}  // namespace carat::cli
