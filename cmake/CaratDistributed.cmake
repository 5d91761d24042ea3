# What is for several processes: carat::parts, which needs nothing; carat::partition where Scotch is
# found, and with PETSc, SLEPc and MPI also carat::distributed. Without them everything else is built.
add_library(carat_parts STATIC src/carat/distributed/message.cpp src/carat/distributed/part_data.cpp
                               src/carat/distributed/part_file.cpp)
add_library(carat::parts ALIAS carat_parts)
target_sources(carat_parts PUBLIC FILE_SET HEADERS BASE_DIRS src
               FILES src/carat/distributed/part_data.h src/carat/distributed/part_file.h)
target_link_libraries(carat_parts PUBLIC carat_core)
set_target_properties(carat_parts PROPERTIES EXPORT_NAME parts POSITION_INDEPENDENT_CODE ON)
carat_warnings(carat_parts)

set(CARAT_HAS_PARTITION OFF)
set(CARAT_HAS_DISTRIBUTED OFF)
if(NOT CARAT_WITH_DISTRIBUTED)
  return()
endif()

find_package(Scotch MODULE QUIET)
if(Scotch_FOUND)
  set(CARAT_HAS_PARTITION ON)
  add_library(carat_partition STATIC src/carat/distributed/partition.cpp)
  add_library(carat::partition ALIAS carat_partition)
  target_sources(carat_partition PUBLIC FILE_SET HEADERS BASE_DIRS src
                 FILES src/carat/distributed/partition.h)
  target_link_libraries(carat_partition PUBLIC carat_core PRIVATE Scotch::Scotch)
  set_target_properties(carat_partition PROPERTIES EXPORT_NAME partition
                                                   POSITION_INDEPENDENT_CODE ON)
  carat_warnings(carat_partition)
else()
  message(STATUS "Scotch not found: no carat::partition (Debian: libscotch-dev)")
endif()

set(MPI_CXX_SKIP_MPICXX ON)
find_package(MPI QUIET COMPONENTS CXX)
find_package(PkgConfig QUIET)
if(MPI_FOUND AND PkgConfig_FOUND)
  pkg_check_modules(PETSC QUIET IMPORTED_TARGET petsc>=3.18 slepc>=3.18)
endif()
if(PETSC_FOUND AND Scotch_FOUND AND CARAT_BUILD_IO)
  set(CARAT_HAS_DISTRIBUTED ON)
  # The flags of Debian's own build are not for ours.
  set_property(TARGET PkgConfig::PETSC PROPERTY INTERFACE_COMPILE_OPTIONS)
  file(GLOB distributed_sources CONFIGURE_DEPENDS src/carat/distributed/*.cpp)
  list(FILTER distributed_sources EXCLUDE REGEX "/(partition|message|part_data|part_file).cpp$")
  add_library(carat_distributed STATIC ${distributed_sources})
  add_library(carat::distributed ALIAS carat_distributed)
  # The other headers show PETSc or MPI.
  target_sources(carat_distributed PUBLIC FILE_SET HEADERS BASE_DIRS src
                 FILES src/carat/distributed/eigenmodes.h src/carat/distributed/heat_geodesics.h
                       src/carat/distributed/mesh_pieces.h
                       src/carat/distributed/poisson.h src/carat/distributed/processes.h
                       src/carat/distributed/read_parts.h src/carat/distributed/scatter.h
                       src/carat/distributed/write_parts.h)
  target_link_libraries(carat_distributed PUBLIC carat_parts carat_io carat_partition
                        PRIVATE PkgConfig::PETSC MPI::MPI_CXX)
  set_target_properties(carat_distributed PROPERTIES EXPORT_NAME distributed)
  carat_warnings(carat_distributed)
else()
  message(STATUS "no carat::distributed: it needs CARAT_BUILD_IO, Scotch, PETSc, SLEPc and MPI "
                 "(Debian: libscotch-dev, petsc-dev, slepc-dev, libopenmpi-dev)")
endif()
