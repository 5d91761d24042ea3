#include "carat/distributed/eigen_checkpoint.h"

#include <petscao.h>

#include <array>
#include <fstream>
#include <functional>
#include <system_error>

#include "carat/distributed/processes.h"

namespace carat {
namespace {

namespace fs = std::filesystem;
using PetscNumbering = PetscOwner<AO, AODestroy>;

constexpr std::array<char, 8> kMagic = {'c', 'a', 'r', 'a', 't', 'e', 'i', 'g'};

struct Header {
  std::array<char, 8> magic = kMagic;
  std::int64_t n_vertices = 0, n_pairs = 0;
};

/// Where things are in the file.
struct Layout {
  std::int64_t n_vertices, n_pairs;

  std::int64_t values() const { return sizeof(Header); }
  std::int64_t vertices() const { return values() + 8 * n_pairs; }
  std::int64_t vector(std::int64_t pair) const {
    return vertices() + 4 * n_vertices + 8 * n_vertices * pair;
  }
  std::int64_t size() const { return vector(n_pairs); }
};

bool is_first() {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return rank == 0;
}

void write_own_rows(const fs::path& path, const Layout& layout, const PartNumbers& numbers,
                    const std::vector<DistributedPair>& pairs) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  const auto write = [&](std::int64_t offset, const void* data, std::size_t size) {
    file.seekp(offset);
    file.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
  };
  const auto n_own = static_cast<std::size_t>(numbers.end_row - numbers.first_row);
  std::vector<Index> vertices(n_own);
  for (Index v = 0; v < static_cast<Index>(numbers.vertices.size()); ++v)
    if (numbers.own_vertex(v))
      vertices[static_cast<std::size_t>(numbers.vertex_rows[v] - numbers.first_row)] =
          numbers.vertices[v];
  write(layout.vertices() + 4 * std::int64_t{numbers.first_row}, vertices.data(), 4 * n_own);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const OwnRows own(pairs[k].vector);
    write(layout.vector(static_cast<std::int64_t>(k)) + 8 * std::int64_t{numbers.first_row},
          own.values().data(), 8 * n_own);
  }
  file.close();
  if (!file) throw IoError(path.string() + ": cannot be written; is the disk full?");
}

/// \return pairs in the file; -1: no file
std::int64_t read_header(const fs::path& path, std::int64_t n_vertices,
                         std::vector<double>& values) {
  std::error_code error;
  if (path.has_parent_path() && !fs::is_directory(path.parent_path(), error))
    throw IoError(path.string() + ": the folder " + path.parent_path().string() +
                  " does not exist; create it first");
  if (!fs::exists(path, error)) return -1;
  std::ifstream file(path, std::ios::binary);
  Header header;
  const auto size = static_cast<std::int64_t>(fs::file_size(path, error));
  if (!file.read(reinterpret_cast<char*>(&header), sizeof(header)) || header.magic != kMagic)
    throw IoError(path.string() +
                  ": is no checkpoint of eigenpairs; name another file or remove it");
  if (header.n_vertices != n_vertices)
    throw IoError(path.string() + ": is the checkpoint of a mesh of " +
                  std::to_string(header.n_vertices) + " vertices, this one has " +
                  std::to_string(n_vertices) + "; name another file or remove it");
  const Layout layout{header.n_vertices, header.n_pairs};
  if (header.n_pairs < 0 || header.n_pairs > n_vertices || size != layout.size())
    throw IoError(path.string() + ": has " + std::to_string(size) +
                  " bytes, not those of a checkpoint of " + std::to_string(header.n_pairs) +
                  " eigenpairs; it is damaged, remove it to start again");
  values.resize(static_cast<std::size_t>(header.n_pairs));
  file.read(reinterpret_cast<char*>(values.data()), 8 * header.n_pairs);
  if (!file) throw IoError(path.string() + ": cannot be read");
  return header.n_pairs;
}

}  // namespace

void save_pairs(const fs::path& path, const PartNumbers& numbers,
                const std::vector<DistributedPair>& pairs) {
  const Layout layout{numbers.n_vertices, static_cast<std::int64_t>(pairs.size())};
  const fs::path temporary = path.string() + ".part";
  const auto write = [&](const std::function<void()>& work) {
    try {
      together(work);
    } catch (const Error&) {
      std::error_code ignored;
      if (is_first()) fs::remove(temporary, ignored);
      throw;
    }
  };
  write([&] {
    if (!is_first()) return;
    std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
    Header header;
    header.n_vertices = layout.n_vertices;
    header.n_pairs = layout.n_pairs;
    file.write(reinterpret_cast<const char*>(&header), sizeof(header));
    for (const DistributedPair& pair : pairs)
      file.write(reinterpret_cast<const char*>(&pair.value), sizeof(double));
    file.close();
    std::error_code error;
    if (file) fs::resize_file(temporary, static_cast<std::uintmax_t>(layout.size()), error);
    if (!file || error)
      throw IoError(path.string() + ": cannot be written: " +
                    (error ? error.message() : std::string("does the folder exist?")));
  });
  write([&] { write_own_rows(temporary, layout, numbers, pairs); });
  write([&] {
    std::error_code error;
    if (is_first()) fs::rename(temporary, path, error);
    if (error) throw IoError(path.string() + ": cannot be written: " + error.message());
  });
}

std::vector<DistributedPair> load_pairs(const fs::path& path, const PartNumbers& numbers,
                                        const PartExchange& exchange) {
  std::vector<double> values;
  std::int64_t n_pairs = 0;
  together([&] {
    if (is_first()) n_pairs = read_header(path, numbers.n_vertices, values);
  });
  n_pairs = sum_of_all(n_pairs);
  if (n_pairs <= 0) return {};
  values.resize(static_cast<std::size_t>(n_pairs));
  values = sum_of_all(std::move(values));

  // The file's rows are those of the processes that wrote it.
  const Layout layout{numbers.n_vertices, n_pairs};
  const Index n_own = exchange.n_own();
  std::vector<PetscInt> vertices(static_cast<std::size_t>(n_own)), rows(vertices.size());
  for (Index v = 0; v < exchange.n_here(); ++v)
    if (numbers.own_vertex(v)) {
      const auto row = static_cast<std::size_t>(numbers.vertex_rows[v] - numbers.first_row);
      vertices[row] = numbers.vertices[v];
      rows[row] = numbers.vertex_rows[v];
    }
  PetscNumbering numbering;
  check(AOCreateMemoryScalable(PETSC_COMM_WORLD, n_own, vertices.data(), rows.data(),
                               numbering.out()));
  std::ifstream file;
  const auto read = [&](std::int64_t offset, void* data, std::int64_t size) {
    file.seekg(offset);
    if (!file.read(static_cast<char*>(data), size))
      throw IoError(path.string() + ": cannot be read; all processes need to see this file");
  };
  together([&] {
    std::vector<Index> in_file(rows.size());
    file.open(path, std::ios::binary);
    read(layout.vertices() + 4 * std::int64_t{numbers.first_row}, in_file.data(), 4 * n_own);
    for (const Index vertex : in_file)
      if (vertex < 0 || vertex >= numbers.n_vertices)
        throw IoError(path.string() + ": names vertex " + std::to_string(vertex) + " of " +
                      std::to_string(numbers.n_vertices) +
                      "; it is damaged, remove it to start again");
    rows.assign(in_file.begin(), in_file.end());
  });
  check(AOApplicationToPetsc(numbering, n_own, rows.data()));
  std::vector<DistributedPair> pairs;
  std::vector<double> own(static_cast<std::size_t>(n_own));
  for (std::int64_t k = 0; k < n_pairs; ++k) {
    together([&] {
      read(layout.vector(k) + 8 * std::int64_t{numbers.first_row}, own.data(), 8 * n_own);
    });
    pairs.push_back({values[static_cast<std::size_t>(k)], exchange.vector()});
    check(VecSetValues(pairs.back().vector, n_own, rows.data(), own.data(), INSERT_VALUES));
    check(VecAssemblyBegin(pairs.back().vector));
    check(VecAssemblyEnd(pairs.back().vector));
  }
  return pairs;
}

}  // namespace carat
