#include "carat/distributed/message.h"
#include "parts.h"
#include "support/same_parts.h"

namespace carat::test {
namespace {

/// The part of the next process, from the first one.
template <class Mesh>
MeshPart<Mesh> sent(const Mesh& mesh, const MeshDivision& division) {
  if (rank() == 0)
    for (int process = 1; process < n_processes(); ++process) {
      Message message;
      put(message, part_of(mesh, division, process));
      message.send(process);
    }
  if (rank() > 0) {
    MeshPart<Mesh> part;
    Message message = Message::receive(0);
    take(message, part);
    return part;
  }
  return part_of(mesh, division, 0);
}

/// What a message gives back.
template <class Mesh>
MeshPart<Mesh> through_message(const MeshPart<Mesh>& part) {
  Message message;
  put(message, part);
  MeshPart<Mesh> taken;
  take(message, taken);
  EXPECT_EQ(message.left(), 0U);
  return taken;
}

TEST(Message, interfaces_may_have_numbers_beyond_32_bits) {
  const auto surface =
      with_first_interface(own_block(surfaces_to_divide()[0].second), kManyInterfaces);
  expect_same(through_message(surface), surface);
  const auto volume = with_first_interface(own_block(hex_grid(3)), kManyInterfaces);
  expect_same(through_message(volume), volume);
}

TEST(Message, parts_arrive_as_they_are) {
  for (const auto& [name, mesh] : surfaces_to_divide()) {
    SCOPED_TRACE(name);
    const MeshDivision division =
        divide(mesh, n_processes(), scattered(mesh.n_faces(), n_processes()));
    const auto part = sent(mesh, division), expected = part_of(mesh, division, rank());
    expect_same(part, expected);
  }
  for (const auto& [name, mesh] : volumes_to_divide()) {
    SCOPED_TRACE(name);
    const MeshDivision division =
        divide(mesh, n_processes(), scattered(mesh.n_cells(), n_processes()));
    const auto part = sent(mesh, division), expected = part_of(mesh, division, rank());
    expect_same(part, expected);
  }
}

TEST(Message, large_ones_go_in_pieces) {
  // Beyond one piece of 2^28 bytes.
  if (n_processes() != 2) return;
  const std::size_t size = (std::size_t{1} << 28) + 12345;
  if (rank() == 0) {
    std::vector<char> values(size);
    for (std::size_t i = 0; i < size; i += 1000) values[i] = static_cast<char>(i % 127);
    Message message;
    message.put_list(values);
    message.send(1);
  } else {
    std::vector<char> values;
    Message message = Message::receive(0);
    message.take_list(values);
    ASSERT_EQ(values.size(), size);
    bool same = true;
    for (std::size_t i = 0; i < size; i += 1000) same &= values[i] == static_cast<char>(i % 127);
    EXPECT_TRUE(same);
    EXPECT_THROW(message.take(same), Error);
  }
}

}  // namespace
}  // namespace carat::test
