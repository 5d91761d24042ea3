#include <string>

#include "arrays.h"
#include "carat/base/error.h"
#include "carat/base/interrupt.h"
#include "modules.h"

namespace carat::python {
namespace {

/// The library's message with the remedy in the words of Python.
std::string in_python(std::string message) {
  const std::string remedy = "use DegeneratePolicy::Report to leave them out";
  if (const std::size_t at = message.find(remedy); at != std::string::npos)
    message.replace(at, remedy.size(), "leave out strict=True");
  return message;
}

/// Raises carat._errors.<name>(message, elements).
void raise(const char* name, const Error& error) {
  try {
    const py::object type = py::module_::import("carat._errors").attr(name);
    const py::object value = type(in_python(error.what()), py::cast(error.elements()));
    PyErr_SetObject(type.ptr(), value.ptr());
  } catch (py::error_already_set& failure) {
    failure.restore();
  }
}

}  // namespace

void define_errors(py::module_&) {
  py::register_exception_translator([](std::exception_ptr failure) {
    try {
      if (failure) std::rethrow_exception(failure);
    } catch (const InvalidMesh& error) {
      raise("InvalidMesh", error);
    } catch (const DegenerateElement& error) {
      raise("DegenerateElement", error);
    } catch (const InvalidOption& error) {
      raise("InvalidOption", error);
    } catch (const IoError& error) {
      raise("IoError", error);
    } catch (const SolverFailure& error) {
      raise("SolverFailure", error);
    } catch (const Error& error) {
      raise("Error", error);
    } catch (const Interrupted&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    }
  });
}

}  // namespace carat::python
