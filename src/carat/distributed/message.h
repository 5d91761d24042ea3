#pragma once
// Bytes between processes, or in a file: put on one side, taken in the same order on the other.

#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "carat/distributed/part_data.h"

namespace carat {

class Message {
 public:
  Message() = default;
  explicit Message(std::vector<char> bytes) : bytes_(std::move(bytes)) {}

  template <class Value>
  requires std::is_trivially_copyable_v<Value>
  void put(const Value& value) { put_bytes(&value, sizeof(Value)); }
  template <class List>
  requires std::is_trivially_copyable_v<typename List::value_type> && requires(const List& list) {
    list.data();
  }
  void put_list(const List& list) {
    put(static_cast<std::uint64_t>(list.size()));
    put_bytes(list.data(), list.size() * sizeof(typename List::value_type));
  }

  template <class Value>
  requires std::is_trivially_copyable_v<Value>
  void take(Value& value) { take_bytes(&value, sizeof(Value)); }
  template <class List>
  requires std::is_trivially_copyable_v<typename List::value_type> && requires(List& list) {
    list.resize(0);
  }
  void take_list(List& list) {
    std::uint64_t size = 0;
    take(size);
    require(size, sizeof(typename List::value_type));
    list.resize(static_cast<std::size_t>(size));
    take_bytes(list.data(), list.size() * sizeof(typename List::value_type));
  }

  /// To another process, in pieces that MPI can count; receive() there.
  void send(int process) const;
  static Message receive(int process);
  std::size_t size() const { return bytes_.size(); }
  std::span<const char> bytes() const { return bytes_; }
  /// What is not taken yet.
  std::size_t left() const { return bytes_.size() - taken_; }
  /// \throws Error  so many values cannot be in it
  void require(std::uint64_t n_values, std::size_t size_of_value) const;

 private:
  void put_bytes(const void* data, std::size_t size);
  void take_bytes(void* data, std::size_t size);

  std::vector<char> bytes_;
  std::size_t taken_ = 0;
};

void put(Message& message, const Csr& rows);
void take(Message& message, Csr& rows);
void put(Message& message, const MeshPart<PolygonMesh>& part);
void put(Message& message, const MeshPart<PolyhedralMesh>& part);
void take(Message& message, MeshPart<PolygonMesh>& part);
void take(Message& message, MeshPart<PolyhedralMesh>& part);
void put(Message& message, const PartData<PolygonMesh>& data);
void put(Message& message, const PartData<PolyhedralMesh>& data);
void take(Message& message, PartData<PolygonMesh>& data);
void take(Message& message, PartData<PolyhedralMesh>& data);

}  // namespace carat
