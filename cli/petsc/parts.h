#pragma once
// Meshes and results between files and commands over several processes. All functions are
// collective.

#include <memory>
#include <string>

#include "carat/distributed/part_data.h"
#include "carat/distributed/processes.h"
#include "carat/operators/part_discretization.h"
#include "cli/boundary_data.h"
#include "cli/files.h"
#include "cli/operator_options.h"
#include "cli/session.h"

namespace carat::cli {

/// The mesh of a command.
struct PartInput {
  AnyPartData data;
  Index n_elements = 0;             ///< of the whole mesh
  std::unique_ptr<MeshData> whole;  ///< in the first process, where a single file is to be written
};

/// Refuses an output before work is spent on it.
/// \throws InvalidOption, IoError  not Shared: to be run together
void check_part_output(const std::string& path);

/// A mesh in parts is read by all, each its own; any other by the first process, which divides it.
/// Reports name, kind and sizes.
/// \param output  of the command: an index in parts, or a single file for which the first process
///                keeps the mesh that it has read; may be empty
/// \throws Shared<...>  as read_mesh, read_parts; a single file of a mesh in parts
PartInput read_part_input(Session& session, const std::string& path, const std::string& output);

/// What is done with matrices: products take their place where they are faster.
enum class MatrixNeed { Entries, Multiplied };

/// What the part brings to the operators. Reports the options, what all found, the sizes of parts,
/// and, of entries, how much of the stiffness crosses from process to process.
template <class Mesh>
Discretization discretize(Session& session, const MeshPart<Mesh>& part,
                          const OperatorOptions& options, DiscretizationParts parts,
                          const Coefficient& coefficient = {},
                          MatrixNeed need = MatrixNeed::Entries);

/// Reports what all parts bring to matrices, and send of it.
void report_share(Session& session, const PartShare& share);

/// Reports the peak memory of all processes: the largest, and the sum.
void report_memory(Session& session);

/// Writes fields of the part, with its mesh, as read_part_input() was told.
template <class Mesh>
void write_part_output(Session& session, const std::string& path, const std::string& title,
                       PartInput& input, const MeshPart<Mesh>& part, MeshFields fields);

/// The extremes over all own vertices.
Extremes part_extremes(const PartNumbers& numbers, const Vector& values);

/// Own interfaces with one element: all sides of the whole boundary, each in one part.
std::vector<Index> boundary_sides(const MeshPart<PolygonMesh>& part);
std::vector<Index> boundary_sides(const MeshPart<PolyhedralMesh>& part);

/// How the processes agree on a boundary.
class SharedBoundary final : public BoundaryParts {
 public:
  explicit SharedBoundary(const PartNumbers& numbers) : numbers_(numbers) {}
  void together(const std::function<void()>& work) const override { carat::together(work); }
  std::vector<std::int64_t> sum(std::vector<std::int64_t> counts) const override;
  void take_lowest(std::vector<int>& entry_of_vertex) const override;
  bool owns(Index vertex) const override { return numbers_.own_vertex(vertex); }

 private:
  const PartNumbers& numbers_;
};

inline std::vector<Field>& element_fields(MeshFields& fields, const PolygonMesh&) {
  return fields.face;
}
inline std::vector<Field>& element_fields(MeshFields& fields, const PolyhedralMesh&) {
  return fields.cell;
}

}  // namespace carat::cli
