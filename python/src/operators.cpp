#include <memory>
#include <string>

#include "arrays.h"
#include "carat/base/error.h"
#include "modules.h"
#include "options.h"
#include "run.h"

namespace carat::python {

py::dict diagnostics_dict(const Diagnostics& diagnostics) {
  py::dict dict;
  for (const Finding& finding : diagnostics.findings())
    dict[py::str(finding.name)] =
        py::make_tuple(finding.meaning, moved_vector(std::vector<Index>(finding.elements)));
  return dict;
}

namespace {

using Operators = std::shared_ptr<Discretization>;

DiscretizationParts parts_of(const std::string& name) {
  return name == "matrices"   ? DiscretizationParts::Matrices
         : name == "gradient" ? DiscretizationParts::Gradient
                              : DiscretizationParts::Frames;
}

/// Makes a matrix of the discretization an array over its memory, or moves it out.
py::tuple matrix_of(const Operators& operators, SparseMatrix Discretization::*matrix) {
  return csr_parts(operators, (*operators).*matrix);
}

template <class Mesh>
void define_discretize(py::module_& module) {
  module.def("discretize", [](const std::shared_ptr<Mesh>& mesh, const py::dict& arguments,
                              const std::string& parts) {
    OperatorRequest wanted = request(*mesh, OperatorArguments::from(arguments));
    wanted.options.parts = parts_of(parts);
    return run([mesh, wanted](Job&) {
      return std::make_shared<Discretization>(discretize(*mesh, wanted.name, wanted.options));
    });
  });
}

template <class Entry>
void list_operators(py::list& list, const char* kind, const std::vector<const Entry*>& entries) {
  for (const Entry* entry : entries) {
    py::list masses;
    for (const MassKind mass : entry->options.masses) masses.append(mass_kind_name(mass));
    py::dict dict;
    dict["name"] = entry->name;
    dict["kind"] = kind;
    dict["title"] = entry->title;
    dict["citation"] = entry->citation;
    dict["masses"] = py::tuple(masses);
    dict["gradient"] = entry->claims.gradient;
    dict["simplices_only"] = entry->claims.simplices_only;
    dict["vertex_unknowns"] = entry->claims.vertex_unknowns;
    dict["definition"] = entry->card.definition;
    dict["when"] = entry->card.when;
    list.append(dict);
  }
}

Vector checked(const In<double>& values, Eigen::Index size, const char* what) {
  if (values.size() != size)
    throw InvalidOption(std::string(what) + ": " + std::to_string(values.size()) + " values for " +
                        std::to_string(size) + " rows of the gradient");
  return to_vector(values);
}

}  // namespace

void define_operators(py::module_& module) {
  py::class_<Discretization, Operators>(module, "Discretization")
      .def_readonly("name", &Discretization::name)
      .def_property_readonly("n_unknowns", &Discretization::n_unknowns)
      .def_property_readonly("n_vertices", &Discretization::n_vertices)
      .def_property_readonly("n_samples", &Discretization::n_samples)
      .def_readonly("gradient_dimension", &Discretization::gradient_dimension)
      .def("stiffness", [](const Operators& d) { return matrix_of(d, &Discretization::stiffness); })
      .def("mass", [](const Operators& d) { return matrix_of(d, &Discretization::mass); })
      .def("gradient", [](const Operators& d) { return matrix_of(d, &Discretization::gradient); })
      .def("laplacian",
           [](const Operators& d) { return moved_csr(run([d](Job&) { return d->laplacian(); })); })
      .def("divergence",
           [](const Operators& d) { return moved_csr(run([d](Job&) { return d->divergence(); })); })
      .def("lumped_mass", [](const Operators& d) { return moved_vector(d->lumped_mass()); })
      .def_property_readonly(
          "sample_measure",
          [](const Operators& d) { return view_of(d, d->sample_measure.data(), {d->n_samples()}); })
      .def_property_readonly(
          "unknown_positions",
          [](const Operators& d) { return moved_points(Points(d->extra.positions)); })
      .def("diagnostics", [](const Operators& d) { return diagnostics_dict(d->diagnostics); })
      .def("mass_kind", [](const Operators& d) { return mass_kind_name(d->options.mass); })
      .def("element_vectors",
           [](const Operators& d, const In<double>& values, Index n_elements) {
             Vector vectors = checked(values, d->gradient.rows(), "element_vectors");
             return moved_points(run([d, n_elements, vectors = std::move(vectors)](Job&) {
               return d->element_vectors(vectors, n_elements);
             }));
           })
      .def("vertex_vectors", [](const Operators& d, const In<double>& values) {
        Vector vectors = checked(values, d->gradient.rows(), "vertex_vectors");
        return moved_points(
            run([d, vectors = std::move(vectors)](Job&) { return d->vertex_vectors(vectors); }));
      });
  define_discretize<PolygonMesh>(module);
  define_discretize<PolyhedralMesh>(module);
  module.def("operators", [] {
    py::list list;
    list_operators(list, "surface", surface_operators());
    list_operators(list, "volume", volume_operators());
    return list;
  });
}

}  // namespace carat::python
