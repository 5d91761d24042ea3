#include "carat/distributed/message.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "carat/base/error.h"

namespace carat {
namespace {

void put(Message& message, const Csr& rows) {
  message.put_list(rows.offsets);
  message.put_list(rows.indices);
}

void take(Message& message, Csr& rows) {
  message.take_list(rows.offsets);
  message.take_list(rows.indices);
}

void put(Message& message, const Points& points) {
  message.put_list(Array<double>(points.data(), points.data() + points.size()));
}

void take(Message& message, Points& points) {
  Array<double> values;
  message.take_list(values);
  points = Eigen::Map<const Points>(values.data(), static_cast<Eigen::Index>(values.size()) / 3, 3);
}

void put(Message& message, const std::vector<bool>& flags) {
  message.put_list(std::vector<char>(flags.begin(), flags.end()));
}

void take(Message& message, std::vector<bool>& flags) {
  std::vector<char> values;
  message.take_list(values);
  flags.assign(values.begin(), values.end());
}

void put(Message& message, const PartNumbers& numbers) {
  for (const Index value : {numbers.part, numbers.n_parts, numbers.first_row, numbers.end_row,
                            numbers.n_vertices, numbers.n_components})
    message.put(value);
  for (const Array<Index>* list :
       {&numbers.vertices, &numbers.vertex_rows, &numbers.vertex_components, &numbers.elements,
        &numbers.interfaces})
    message.put_list(*list);
  put(message, numbers.own_elements);
  put(message, numbers.own_interfaces);
}

void take(Message& message, PartNumbers& numbers) {
  for (Index* const value : {&numbers.part, &numbers.n_parts, &numbers.first_row, &numbers.end_row,
                             &numbers.n_vertices, &numbers.n_components})
    message.take(*value);
  for (Array<Index>* list : {&numbers.vertices, &numbers.vertex_rows, &numbers.vertex_components,
                             &numbers.elements, &numbers.interfaces})
    message.take_list(*list);
  take(message, numbers.own_elements);
  take(message, numbers.own_interfaces);
}

}  // namespace

void Message::put_bytes(const void* data, std::size_t size) {
  if (size == 0) return;
  bytes_.resize(bytes_.size() + size);
  std::memcpy(bytes_.data() + bytes_.size() - size, data, size);
}

void Message::require(std::uint64_t n_values, std::size_t size_of_value) const {
  if (n_values > left() / size_of_value)
    throw Error("a message ends before " + std::to_string(n_values) + " values of " +
                std::to_string(size_of_value) + " bytes that it should hold");
}

void Message::take_bytes(void* data, std::size_t size) {
  require(size, 1);
  if (size > 0) std::memcpy(data, bytes_.data() + taken_, size);
  taken_ += size;
}

void put(Message& message, const MeshPart<PolygonMesh>& part) {
  put(message, part.numbers);
  put(message, part.mesh.points());
  put(message, part.mesh.faces());
}

void put(Message& message, const MeshPart<PolyhedralMesh>& part) {
  put(message, part.numbers);
  put(message, part.mesh.points());
  put(message, part.mesh.face_mesh().faces());
  put(message, part.mesh.cells());
  message.put_list(part.mesh.face_cells());
}

void take(Message& message, MeshPart<PolygonMesh>& part) {
  Points points;
  Csr faces;
  take(message, part.numbers);
  take(message, points);
  take(message, faces);
  part.mesh = PolygonMesh(std::move(points), std::move(faces));
}

void take(Message& message, MeshPart<PolyhedralMesh>& part) {
  Points points;
  Csr faces, cells;
  Array<FaceCells> face_cells;
  take(message, part.numbers);
  take(message, points);
  take(message, faces);
  take(message, cells);
  message.take_list(face_cells);
  part.mesh = PolyhedralMesh::from_face_cells(std::move(points), std::move(faces), std::move(cells),
                                              std::move(face_cells));
}

}  // namespace carat
