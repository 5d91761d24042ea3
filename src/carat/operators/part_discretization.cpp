#include "carat/operators/part_discretization.h"

#include "carat/base/error.h"
#include "carat/operators/common.h"
#include "carat/operators/registry.h"

namespace carat {
namespace {

const SurfaceOperator& find_operator(const PolygonMesh&, const std::string& name) {
  return surface_operator(name);
}
const VolumeOperator& find_operator(const PolyhedralMesh&, const std::string& name) {
  return volume_operator(name);
}

/// The options on the part's own elements alone.
DiscretizationOptions on_own_elements(DiscretizationOptions options, const PartNumbers& numbers) {
  options.own_interfaces.clear();
  if (options.cell_coefficient.size() == 0) return options;
  check_cell_coefficient(options, static_cast<Index>(numbers.elements.size()));
  Index n_own = 0;
  for (Index c = 0; c < options.cell_coefficient.rows(); ++c)
    if (numbers.own_elements[c])
      options.cell_coefficient.row(n_own++) = options.cell_coefficient.row(c).eval();
  options.cell_coefficient.conservativeResize(n_own, Eigen::NoChange);
  return options;
}

template <class Mesh>
Discretization discretize_own(const MeshPart<Mesh>& part, const std::string& name,
                              DiscretizationOptions options) {
  const auto& entry = find_operator(part.mesh, name);
  if (entry.options.own_interfaces) {
    options.own_interfaces = part.numbers.own_interfaces;
    return discretize(part.mesh, name, options);
  }
  if (!entry.claims.face_local || !entry.claims.vertex_unknowns)
    throw InvalidOption("the operator " + name +
                        " cannot be assembled in parts; choose another, e.g. diamond");
  return discretize(own_mesh(part), name, on_own_elements(options, part.numbers));
}

template <class Mesh>
SparseMatrix sparser_own(const MeshPart<Mesh>& part, const Discretization& discretization) {
  // The others couple single elements already, and have been made on the own ones alone.
  if (!find_operator(part.mesh, discretization.name).options.own_interfaces) return {};
  Discretization own;
  own.name = discretization.name;
  own.options = on_own_elements(discretization.options, part.numbers);
  const Mesh mesh = own_mesh(part);
  const std::function<SparseMatrix()> assemble = sparser_stiffness(mesh, own);
  return assemble();
}

}  // namespace

Discretization discretize_part(const MeshPart<PolygonMesh>& part, const std::string& operator_name,
                               const DiscretizationOptions& options) {
  return discretize_own(part, operator_name, options);
}

Discretization discretize_part(const MeshPart<PolyhedralMesh>& part,
                               const std::string& operator_name,
                               const DiscretizationOptions& options) {
  return discretize_own(part, operator_name, options);
}

SparseMatrix sparser_part_stiffness(const MeshPart<PolygonMesh>& part,
                                    const Discretization& discretization) {
  return sparser_own(part, discretization);
}

SparseMatrix sparser_part_stiffness(const MeshPart<PolyhedralMesh>& part,
                                    const Discretization& discretization) {
  return sparser_own(part, discretization);
}

PartShare share_of(const SparseMatrix& of_part, const PartNumbers& numbers) {
  PartShare share;
  for (Index v = 0; v < of_part.rows(); ++v) {
    std::int64_t in_row = 0;
    for (SparseMatrix::InnerIterator entry(of_part, v); entry; ++entry)
      if (entry.value() != 0) ++in_row;
    share.entries += in_row;
    if (!numbers.own_vertex(v)) share.sent += in_row;
  }
  return share;
}

}  // namespace carat
