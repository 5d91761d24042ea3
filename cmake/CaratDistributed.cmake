# What is for several processes: carat::partition where Scotch is found. Without it everything else
# is built.
set(CARAT_HAS_PARTITION OFF)
if(NOT CARAT_WITH_DISTRIBUTED)
  return()
endif()

find_package(Scotch MODULE QUIET)
if(Scotch_FOUND)
  set(CARAT_HAS_PARTITION ON)
  add_library(carat_partition STATIC src/carat/distributed/partition.cpp)
  add_library(carat::partition ALIAS carat_partition)
  target_link_libraries(carat_partition PUBLIC carat_core PRIVATE Scotch::Scotch)
  set_target_properties(carat_partition PROPERTIES POSITION_INDEPENDENT_CODE ON)
  carat_warnings(carat_partition)
else()
  message(STATUS "Scotch not found: no carat::partition (Debian: libscotch-dev)")
endif()
