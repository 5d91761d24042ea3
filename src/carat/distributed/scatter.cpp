#include "carat/distributed/scatter.h"

#include <algorithm>
#include <utility>

#include "carat/distributed/message.h"
#include "carat/distributed/processes.h"

namespace carat {
namespace {

template <class Mesh>
AnyPartData take_part(Message& message) {
  PartData<Mesh> data;
  take(message, data);
  return data;
}

/// Sends all parts but the first's own.
template <class Data>
Message send_parts(const Data& whole, std::span<const Index> element_part) {
  const int n = n_processes();
  MeshDivision division;
  on_first([&] { division = divide(whole.mesh, n, element_part); });
  Message message;
  for (int process = n; process-- > 0;) {
    message = Message();
    message.put(std::is_same_v<Data, VolumeData>);
    put(message, part_data_of(whole, division, process));
    if (process > 0) message.send(process);
  }
  return message;
}

/// \param own  which rows are this process's to give, and their numbers in the whole mesh
template <class IsOwn>
Matrix gather(const Array<Index>& numbers, const IsOwn& own, const Matrix& values, Index n_whole) {
  std::vector<Index> rows;
  for (std::size_t k = 0; k < numbers.size(); ++k)
    if (own(static_cast<Index>(k))) rows.push_back(static_cast<Index>(k));
  if (own_rank() > 0) {
    Message message;
    std::vector<Index> places;
    std::vector<double> own_values;
    own_values.reserve(rows.size() * static_cast<std::size_t>(values.cols()));
    for (const Index row : rows) places.push_back(numbers[row]);
    for (Index column = 0; column < values.cols(); ++column)
      for (const Index row : rows) own_values.push_back(values(row, column));
    message.put_list(places);
    message.put_list(own_values);
    message.send(0);
    return {};
  }
  Matrix whole = Matrix::Zero(n_whole, values.cols());
  for (const Index row : rows) whole.row(numbers[row]) = values.row(row);
  for (int process = 1; process < n_processes(); ++process) {
    Message message = Message::receive(process);
    std::vector<Index> places;
    std::vector<double> own_values;
    message.take_list(places);
    message.take_list(own_values);
    std::size_t next = 0;
    for (Index column = 0; column < whole.cols(); ++column)
      for (const Index place : places) whole(place, column) = own_values[next++];
  }
  return whole;
}

}  // namespace

AnyPartData scatter(const MeshData* whole, std::span<const Index> element_part) {
  Message message;
  if (own_rank() == 0) {
    message = std::visit([&](const auto& data) { return send_parts(data, element_part); }, *whole);
  } else {
    on_first([] {});  // the division
    message = Message::receive(0);
  }
  AnyPartData data;
  together([&] {
    bool volume = false;
    message.take(volume);
    data = volume ? take_part<PolyhedralMesh>(message) : take_part<PolygonMesh>(message);
  });
  return data;
}

Matrix gather_vertices(const PartNumbers& numbers, const Matrix& values) {
  return gather(
      numbers.vertices, [&](Index v) { return numbers.own_vertex(v); }, values, numbers.n_vertices);
}

Matrix gather_elements(const PartNumbers& numbers, const Matrix& values, Index n_whole) {
  return gather(
      numbers.elements, [&](Index e) { return numbers.own_elements[static_cast<std::size_t>(e)]; },
      values, n_whole);
}

std::vector<Index> gather_numbers(std::vector<Index> numbers) {
  if (own_rank() > 0) {
    Message message;
    message.put_list(numbers);
    message.send(0);
    return {};
  }
  for (int process = 1; process < n_processes(); ++process) {
    Message message = Message::receive(process);
    std::vector<Index> more;
    message.take_list(more);
    numbers.insert(numbers.end(), more.begin(), more.end());
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

}  // namespace carat
