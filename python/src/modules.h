#pragma once
// The parts of the extension module, and what they share.

#include <pybind11/pybind11.h>

#include <memory>

#include "carat/base/diagnostics.h"
#include "carat/io/mesh_file.h"
#include "carat/mesh/polyhedral_mesh.h"

namespace carat::python {

void define_errors(pybind11::module_& module);
void define_meshes(pybind11::module_& module);
void define_files(pybind11::module_& module);
void define_operators(pybind11::module_& module);
void define_problems(pybind11::module_& module);

/// Name -> (meaning, elements).
pybind11::dict diagnostics_dict(const Diagnostics& diagnostics);

using Surface = std::shared_ptr<PolygonMesh>;
using Volume = std::shared_ptr<PolyhedralMesh>;

inline constexpr int dimension(const PolygonMesh&) { return 2; }
inline constexpr int dimension(const PolyhedralMesh&) { return 3; }
inline Index n_elements(const PolygonMesh& mesh) { return mesh.n_faces(); }
inline Index n_elements(const PolyhedralMesh& mesh) { return mesh.n_cells(); }

}  // namespace carat::python
