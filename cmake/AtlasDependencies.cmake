# Every third-party package is looked up here and nowhere else, so that a missing one is reported
# at once and with its Debian package name (see scripts/install-deps.sh).

find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)                # libtbb-dev: threads
find_package(Eigen3 REQUIRED NO_MODULE)   # libeigen3-dev: sparse solvers
find_package(glm REQUIRED)                # libglm-dev: vectors and matrices
find_package(fmt REQUIRED)                # libfmt-dev: text
find_package(nlohmann_json REQUIRED)      # nlohmann-json3-dev: reports
find_package(meshoptimizer REQUIRED)      # libmeshoptimizer-dev: compressed glTF
find_package(ZLIB REQUIRED)               # zlib1g-dev: gzipped worlds
find_package(PNG REQUIRED)                # libpng-dev: PNG files
find_package(JPEG REQUIRED)               # libjpeg-dev: JPEG files
set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE TRUE)
find_package(CGAL REQUIRED)               # libcgal-dev: exact predicates
find_library(LIBATLAS_MPFR_LIBRARY mpfr REQUIRED)  # which CGAL's predicates need
find_library(LIBATLAS_GMP_LIBRARY gmp REQUIRED)
find_path(DRACO_INCLUDE_DIR draco/compression/decode.h REQUIRED)
find_library(LIBATLAS_DRACO_LIBRARY draco REQUIRED)  # libdraco-dev: compressed glTF
find_path(WEBP_INCLUDE_DIR webp/encode.h REQUIRED)
find_library(LIBATLAS_WEBP_LIBRARY webp REQUIRED)    # libwebp-dev: pages as WebP
pkg_check_modules(OIIO REQUIRED IMPORTED_TARGET OpenImageIO)  # libopenimageio-dev: other image files

find_path(OPENMESH_INCLUDE_DIR OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh REQUIRED)
find_library(OPENMESH_CORE_LIBRARY OpenMeshCore REQUIRED)     # libopenmesh-dev: half-edges
add_library(atlas_openmesh INTERFACE)
target_include_directories(atlas_openmesh SYSTEM INTERFACE ${OPENMESH_INCLUDE_DIR})
target_link_libraries(atlas_openmesh INTERFACE ${OPENMESH_CORE_LIBRARY})

# Not every system has CMake packages of these libraries, so their files are looked up and become
# targets. cmake/libatlasConfig.cmake.in makes the same targets for users of the installed library.
foreach(found mpfr=${LIBATLAS_MPFR_LIBRARY} gmp=${LIBATLAS_GMP_LIBRARY}
              draco=${LIBATLAS_DRACO_LIBRARY} webp=${LIBATLAS_WEBP_LIBRARY} OpenMeshCore=${OPENMESH_CORE_LIBRARY})
  string(REGEX MATCH "^([^=]*)=(.*)$" found "${found}")
  add_library(libatlas::${CMAKE_MATCH_1} UNKNOWN IMPORTED GLOBAL)
  set_target_properties(libatlas::${CMAKE_MATCH_1} PROPERTIES IMPORTED_LOCATION ${CMAKE_MATCH_2})
endforeach()
set_target_properties(libatlas::draco PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${DRACO_INCLUDE_DIR})
set_target_properties(libatlas::webp PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${WEBP_INCLUDE_DIR})

if(LIBATLAS_BUILD_TESTS)
  find_package(GTest REQUIRED)            # libgtest-dev
  include(GoogleTest)
endif()
if(LIBATLAS_BUILD_BENCHMARKS)
  find_package(benchmark REQUIRED)        # libbenchmark-dev
endif()
if(LIBATLAS_BUILD_APPS OR LIBATLAS_BUILD_EXAMPLES)
  find_package(CLI11 REQUIRED)            # libcli11-dev: command lines
endif()
if(LIBATLAS_BUILD_EXAMPLES OR LIBATLAS_BUILD_TESTS)
  find_package(embree 4 QUIET)            # libembree-dev: the sample scene's light, tests' rays
  if(NOT embree_FOUND)
    find_package(embree 3 REQUIRED)
  endif()
endif()
if(LIBATLAS_BUILD_PLAYER)
  find_package(glfw3 3.3 REQUIRED)                              # libglfw3-dev: windows
  pkg_check_modules(EPOXY REQUIRED IMPORTED_TARGET epoxy)       # libepoxy-dev: OpenGL entry points
  pkg_check_modules(EGL REQUIRED IMPORTED_TARGET egl)           # libegl-dev: contexts without a window
  pkg_check_modules(IMGUI REQUIRED IMPORTED_TARGET imgui)       # libimgui-dev: the player's panels
endif()
