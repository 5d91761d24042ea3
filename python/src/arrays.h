#pragma once
// NumPy arrays from and to the library's own, without copies where memory can be handed over.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <utility>
#include <vector>

#include "carat/base/types.h"

namespace carat::python {

namespace py = pybind11;

/// C-ordered, of exactly this type: what the Python side hands over, so that nothing is converted
/// unseen.
template <class T>
using In = py::array_t<T, py::array::c_style>;

/// An array over memory that lives as long as `owner`.
/// \param strides  in values; empty: C order
template <class T, class Owner>
py::array_t<T> array_over(std::shared_ptr<Owner> owner, const T* data,
                          std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides = {}) {
  using Held = std::shared_ptr<Owner>;
  const py::capsule keeps(new Held(std::move(owner)),
                          [](void* held) { delete static_cast<Held*>(held); });
  for (py::ssize_t& stride : strides) stride *= static_cast<py::ssize_t>(sizeof(T));
  if (strides.empty()) return py::array_t<T>(std::move(shape), data, keeps);
  return py::array_t<T>(std::move(shape), std::move(strides), data, keeps);
}

/// The same that must not be written to: the memory of something immutable.
template <class T, class Owner>
py::array_t<T> view_of(std::shared_ptr<Owner> owner, const T* data,
                       std::vector<py::ssize_t> shape) {
  py::array_t<T> array = array_over(std::move(owner), data, std::move(shape));
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// Moves a vector or matrix out.
template <class Vector>
auto moved_vector(Vector&& vector) {
  auto held = std::make_shared<std::remove_cvref_t<Vector>>(std::forward<Vector>(vector));
  const auto* const data = held->data();
  const auto size = static_cast<py::ssize_t>(held->size());
  return array_over(std::move(held), data, {size});
}
inline py::array_t<double> moved_matrix(Matrix&& matrix) {
  auto held = std::make_shared<Matrix>(std::move(matrix));
  const double* const data = held->data();
  const py::ssize_t rows = held->rows(), columns = held->cols();
  return array_over(std::move(held), data, {rows, columns}, {1, std::max<py::ssize_t>(rows, 1)});
}
inline py::array_t<double> moved_points(Points&& points) {
  auto held = std::make_shared<Points>(std::move(points));
  const double* const data = held->data();
  const py::ssize_t rows = held->rows();
  return array_over(std::move(held), data, {rows, 3});
}

/// (data, indices, indptr, shape) of a matrix, over its own memory.
/// \param owner  what keeps the matrix alive
template <class Owner>
py::tuple csr_parts(const std::shared_ptr<Owner>& owner, const SparseMatrix& matrix) {
  const py::ssize_t n = matrix.nonZeros();
  return py::make_tuple(array_over(owner, matrix.valuePtr(), {n}),
                        array_over(owner, matrix.innerIndexPtr(), {n}),
                        array_over(owner, matrix.outerIndexPtr(), {matrix.rows() + 1}),
                        py::make_tuple(matrix.rows(), matrix.cols()));
}
inline py::tuple moved_csr(SparseMatrix&& matrix) {
  const auto held = std::make_shared<SparseMatrix>(std::move(matrix));
  return csr_parts(held, *held);
}

inline Points to_points(const In<double>& array) {
  Points points(array.shape(0), 3);
  std::copy_n(array.data(), array.size(), points.data());
  return points;
}
inline Vector to_vector(const In<double>& array) {
  return Eigen::Map<const Vector>(array.data(), array.size());
}
template <class T>
std::vector<T> to_list(const In<T>& array) {
  return {array.data(), array.data() + array.size()};
}
inline std::vector<Index> ids_where(const std::vector<bool>& flags) {
  std::vector<Index> ids;
  for (std::size_t i = 0; i < flags.size(); ++i)
    if (flags[i]) ids.push_back(static_cast<Index>(i));
  return ids;
}

}  // namespace carat::python
