#include "carat/distributed/message.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "carat/base/error.h"

namespace carat {

void put(Message& message, const Csr& rows) {
  message.put_list(rows.offsets);
  message.put_list(rows.indices);
}

void take(Message& message, Csr& rows) {
  message.take_list(rows.offsets);
  message.take_list(rows.indices);
}

namespace {

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
       {&numbers.vertices, &numbers.vertex_rows, &numbers.vertex_components, &numbers.elements})
    message.put_list(*list);
  message.put_list(numbers.interfaces);
  put(message, numbers.own_elements);
  put(message, numbers.own_interfaces);
}

void take(Message& message, PartNumbers& numbers) {
  for (Index* const value : {&numbers.part, &numbers.n_parts, &numbers.first_row, &numbers.end_row,
                             &numbers.n_vertices, &numbers.n_components})
    message.take(*value);
  for (Array<Index>* list :
       {&numbers.vertices, &numbers.vertex_rows, &numbers.vertex_components, &numbers.elements})
    message.take_list(*list);
  message.take_list(numbers.interfaces);
  take(message, numbers.own_elements);
  take(message, numbers.own_interfaces);
}

void put(Message& message, const std::vector<Field>& fields) {
  message.put(static_cast<std::uint64_t>(fields.size()));
  for (const Field& field : fields) {
    message.put_list(field.name);
    message.put(field.components);
    message.put_list(field.values);
  }
}

void take(Message& message, std::vector<Field>& fields) {
  std::uint64_t n = 0;
  message.take(n);
  message.require(n, 1);
  fields.clear();
  for (std::uint64_t k = 0; k < n; ++k) {
    Field field;
    message.take_list(field.name);
    message.take(field.components);
    message.take_list(field.values);
    fields.push_back(std::move(field));
  }
}

template <class Mesh>
void put_data(Message& message, const PartData<Mesh>& data) {
  put(message, data.part);
  for (const std::vector<Field>* fields :
       {&data.fields.vertex, &data.fields.face, &data.fields.cell})
    put(message, *fields);
  message.put(static_cast<std::uint64_t>(data.patches.size()));
  for (const BoundaryPatch& patch : data.patches) {
    message.put_list(patch.name);
    message.put_list(patch.type);
    message.put_list(patch.faces);
  }
}

template <class Mesh>
void take_data(Message& message, PartData<Mesh>& data) {
  take(message, data.part);
  for (std::vector<Field>* fields : {&data.fields.vertex, &data.fields.face, &data.fields.cell})
    take(message, *fields);
  std::uint64_t n = 0;
  message.take(n);
  message.require(n, 1);
  data.patches.clear();
  for (std::uint64_t k = 0; k < n; ++k) {
    BoundaryPatch patch;
    message.take_list(patch.name);
    message.take_list(patch.type);
    message.take_list(patch.faces);
    data.patches.push_back(std::move(patch));
  }
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

void put(Message& message, const PartData<PolygonMesh>& data) { put_data(message, data); }
void put(Message& message, const PartData<PolyhedralMesh>& data) { put_data(message, data); }
void take(Message& message, PartData<PolygonMesh>& data) { take_data(message, data); }
void take(Message& message, PartData<PolyhedralMesh>& data) { take_data(message, data); }

}  // namespace carat
