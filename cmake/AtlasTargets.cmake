# The project's own target helpers: compile options in one place, one static library a folder.

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

add_library(atlas_options INTERFACE)
if(LIBATLAS_TUNING)
  include(${PROJECT_SOURCE_DIR}/benchmarks/ablation/AtlasTuning.cmake)
  target_include_directories(atlas_options INTERFACE ${ATLAS_TUNED_SOURCES})  # before the plain ones
endif()
target_include_directories(atlas_options INTERFACE ${PROJECT_SOURCE_DIR})
# Contraction would let the compiler fuse a*b+c differently on different targets: results must be
# the same on every machine, so it is off.
target_compile_options(atlas_options INTERFACE -Wall -Wextra -Wshadow -ffp-contract=off
                                               $<$<BOOL:${LIBATLAS_WERROR}>:-Werror>)
# Templates of header-only packages leave weak symbols in the library, which the linker merges with
# those of a program that uses the same package. Where the two were compiled with other flags they
# differ: Eigen, for one, allocates and frees memory in another way with AVX than without, and a program
# that mixes both ways crashes. So these packages are compiled into namespaces of the library's own.
# tests/package/check_symbols.cmake holds the libraries to this. Packages whose compiled libraries are
# linked (OpenMesh, fmt, oneTBB, Draco) cannot be renamed, and neither can Boost, whose macros form the
# names of headers.
target_compile_definitions(atlas_options INTERFACE
  Eigen=atlas_eigen CGAL=atlas_cgal nlohmann=atlas_nlohmann)
# GCC 12 sees overflows and uninitialised reads in fmt's and the standard library's own headers once it
# has inlined them at -O3: these stay warnings.
if(LIBATLAS_WERROR AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(atlas_options INTERFACE -Wno-error=stringop-overflow -Wno-error=array-bounds
                                                 -Wno-error=maybe-uninitialized -Wno-error=restrict)
endif()
# What runs once and shortly, such as tests and command lines, is compiled at -O1, which is shorter by
# more than its run is longer: whole targets with the property ATLAS_RUN_ONCE, and the sources named here.
if(CMAKE_BUILD_TYPE STREQUAL "RelWithDebInfo" OR CMAKE_BUILD_TYPE STREQUAL "Release")
  target_compile_options(atlas_options INTERFACE $<IF:$<BOOL:$<TARGET_PROPERTY:ATLAS_RUN_ONCE>>,-O1,-O3>)
  set(ATLAS_RUN_ONCE_OPTIONS -O1)
endif()

# atlas_run_once(a.cpp ...): sources of this folder's targets that run once and shortly.
function(atlas_run_once)
  set_property(SOURCE ${ARGN} APPEND PROPERTY COMPILE_OPTIONS ${ATLAS_RUN_ONCE_OPTIONS})
endfunction()

# atlas_join(TARGET): the target's sources of one folder are compiled together, which takes a third of
# the time, since headers and templates are compiled once. So files of one folder name things apart.
function(atlas_join target)
  if(NOT LIBATLAS_UNITY)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    get_filename_component(folder ${source} DIRECTORY)
    if(LIBATLAS_TUNING)
      string(REPLACE "${ATLAS_TUNED_SOURCES}/libatlas/" "" folder "${folder}")
    endif()
    set_property(SOURCE ${source} PROPERTY UNITY_GROUP "_${folder}")
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # To GCC, a joined source is a header, whose classes should hold nothing of an unnamed namespace.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()

# atlas_module(NAME SOURCES a.cpp ... [DEPENDS core scene ...] [PRIVATE_LIBS target ...])
# Declares libatlas/NAME as the static library atlas_NAME. DEPENDS names folders of libatlas;
# PRIVATE_LIBS are third-party targets that no public header of the folder shows.
function(atlas_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;PRIVATE_LIBS" ${ARGN})
  if(LIBATLAS_TUNING AND name IN_LIST ATLAS_TUNED_FOLDERS)
    list(TRANSFORM ARG_SOURCES PREPEND ${ATLAS_TUNED_SOURCES}/libatlas/${name}/)
  endif()
  add_library(atlas_${name} STATIC ${ARG_SOURCES})
  target_link_libraries(atlas_${name} PUBLIC atlas_options)
  foreach(dep IN LISTS ARG_DEPENDS)
    target_link_libraries(atlas_${name} PUBLIC atlas_${dep})
  endforeach()
  target_link_libraries(atlas_${name} PRIVATE ${ARG_PRIVATE_LIBS})
  atlas_join(atlas_${name})
  set_property(GLOBAL APPEND PROPERTY ATLAS_MODULES ${name})
endfunction()

# atlas_test(NAME SOURCES ... MODULES core scene ... [LIBS target ...] [LABEL quick|heavy])
# One GoogleTest program; each of its cases becomes a ctest entry carrying LABEL (quick by default).
function(atlas_test name)
  cmake_parse_arguments(ARG "" "LABEL" "SOURCES;MODULES;LIBS" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL quick)
  endif()
  add_executable(test_${name} ${ARG_SOURCES})
  set_target_properties(test_${name} PROPERTIES ATLAS_RUN_ONCE ON)
  atlas_join(test_${name})
  foreach(module IN LISTS ARG_MODULES)
    target_link_libraries(test_${name} PRIVATE atlas_${module})
  endforeach()
  target_link_libraries(test_${name} PRIVATE ${ARG_LIBS} GTest::gtest GTest::gtest_main)
  gtest_discover_tests(test_${name} TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60
                       PROPERTIES LABELS ${ARG_LABEL} TIMEOUT 600)
endfunction()
