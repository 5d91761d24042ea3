# Finds SuiteSparse's CHOLMOD: target Cholmod::Cholmod, variable Cholmod_FOUND.
find_path(Cholmod_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
find_library(Cholmod_LIBRARY cholmod)
mark_as_advanced(Cholmod_INCLUDE_DIR Cholmod_LIBRARY)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Cholmod REQUIRED_VARS Cholmod_LIBRARY Cholmod_INCLUDE_DIR)
if(Cholmod_FOUND AND NOT TARGET Cholmod::Cholmod)
  add_library(Cholmod::Cholmod UNKNOWN IMPORTED)
  set_target_properties(Cholmod::Cholmod PROPERTIES
    IMPORTED_LOCATION ${Cholmod_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${Cholmod_INCLUDE_DIR})
endif()
