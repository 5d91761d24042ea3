// The extension module carat._core: what the package's Python files are thin shells of. Its
// functions take arrays of one exact type and shape; carat/_arrays.py makes them so.

#include "modules.h"
#include "run.h"

namespace carat::python {

PYBIND11_MODULE(_core, module) {
  module.doc() = "The compiled part of carat; use the package carat itself.";
  module.attr("version") = CARAT_VERSION;
  define_errors(module);
  define_meshes(module);
  define_files(module);
  define_operators(module);
  define_problems(module);
  module.def("wait_for_abandoned", &wait_for_abandoned);
}

}  // namespace carat::python
