#pragma once
// carat operators: what its runs in one process and in several share.

#include <filesystem>
#include <string>
#include <vector>

#include "carat/mesh/polyhedral_mesh.h"
#include "carat/operators/discretization.h"
#include "cli/operator_options.h"
#include "cli/session.h"

namespace carat::cli {

struct OperatorsArguments {
  std::string input, output;
  OperatorOptions discretization;
};

/// A folder for files that are not complete. What is left in it is removed in the end.
class TemporaryFolder {
 public:
  /// Inside `target` if it exists (so that moving the files is a rename), else beside it.
  /// \throws IoError
  explicit TemporaryFolder(const std::filesystem::path& target);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Moves everything to the target.
  void publish(const std::vector<std::string>& files) const;

 private:
  std::filesystem::path target_, path_;
  bool exists_ = false;
};

/// A matrix among the files.
struct MatrixFile {
  std::string name, comment;
  bool symmetric;
};
/// Of an operator with what it has, in the order of the files.
MatrixFile stiffness_file(const Discretization& d);
MatrixFile mass_file(const Discretization& d, const std::string& measure);
MatrixFile gradient_file(const Discretization& d);
MatrixFile divergence_file(const Discretization& d);
MatrixFile inner_product_file(const Discretization& d);

/// Reports the conventions, writes operators.json and moves all files to the target.
/// \param faces_and_sides  samples are diamonds at the sides of a volume's faces
void publish_operators(Session& session, const OperatorsArguments& arguments,
                       const TemporaryFolder& folder, std::vector<std::string> files,
                       const Discretization& d, const OperatorClaims& claims,
                       const std::string& measure, bool faces_and_sides);

/// What the operator promises on this kind of mesh.
const OperatorClaims& claims_of(const PolygonMesh& mesh, const std::string& name);
const OperatorClaims& claims_of(const PolyhedralMesh& mesh, const std::string& name);

}  // namespace carat::cli
