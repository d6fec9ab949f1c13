# Every third-party package is looked up here and nowhere else, so that a missing one is reported
# at once and with its Debian package name (see scripts/install-deps.sh).

find_package(Threads REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)   # libeigen3-dev: sparse solvers
find_package(glm REQUIRED)                # libglm-dev: vectors and matrices
find_package(fmt REQUIRED)                # libfmt-dev: text, in the component uv as headers only
set(LIBATLAS_USES_TBB OFF)
if(LIBATLAS_TBB)
  find_package(TBB QUIET)                 # libtbb-dev: threads
  set(LIBATLAS_USES_TBB ${TBB_FOUND})
endif()
# Eigen adds up in another order with the vectors of each processor, and uvs have the same bits on all.
# Its sparse factorisations, for which it is used, have no vectors anyway.
add_library(atlas_eigen INTERFACE)
target_link_libraries(atlas_eigen INTERFACE Eigen3::Eigen)
target_compile_definitions(atlas_eigen INTERFACE EIGEN_DONT_VECTORIZE)

set(libraries "")
if(LIBATLAS_BUILD_TESTS OR LIBATLAS_CGAL_PARAMETERIZATION)
  set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE TRUE)
  find_package(CGAL REQUIRED)             # libcgal-dev: oracle of the tests, optional backend
endif()
if(LIBATLAS_CGAL_PARAMETERIZATION)
  find_library(LIBATLAS_MPFR_LIBRARY mpfr REQUIRED)
  find_library(LIBATLAS_GMP_LIBRARY gmp REQUIRED)
  list(APPEND libraries mpfr=${LIBATLAS_MPFR_LIBRARY} gmp=${LIBATLAS_GMP_LIBRARY})
endif()
if("reading" IN_LIST ATLAS_COMPONENTS)
  find_package(PkgConfig REQUIRED)
  find_package(nlohmann_json REQUIRED)    # nlohmann-json3-dev: reports
  find_package(meshoptimizer REQUIRED)    # libmeshoptimizer-dev: compressed glTF
  find_package(ZLIB REQUIRED)             # zlib1g-dev: gzipped worlds
  find_package(PNG REQUIRED)              # libpng-dev: PNG files
  find_package(JPEG REQUIRED)             # libjpeg-dev: JPEG files
  find_path(TINYGLTF_INCLUDE_DIR tiny_gltf.h REQUIRED)  # libtinygltf-dev: reading glTF
  find_path(DRACO_INCLUDE_DIR draco/compression/decode.h REQUIRED)
  find_library(LIBATLAS_DRACO_LIBRARY draco REQUIRED)   # libdraco-dev: compressed glTF
  find_path(WEBP_INCLUDE_DIR webp/encode.h REQUIRED)
  find_library(LIBATLAS_WEBP_LIBRARY webp REQUIRED)     # libwebp-dev: pages as WebP
  list(APPEND libraries draco=${LIBATLAS_DRACO_LIBRARY} webp=${LIBATLAS_WEBP_LIBRARY})
  pkg_check_modules(OIIO REQUIRED IMPORTED_TARGET OpenImageIO)  # libopenimageio-dev: other image files
endif()
if("baking" IN_LIST ATLAS_COMPONENTS)
  find_path(OPENMESH_INCLUDE_DIR OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh REQUIRED)
  find_library(OPENMESH_CORE_LIBRARY OpenMeshCore REQUIRED)     # libopenmesh-dev: half-edges
  add_library(atlas_openmesh INTERFACE)
  target_include_directories(atlas_openmesh SYSTEM INTERFACE ${OPENMESH_INCLUDE_DIR})
  target_link_libraries(atlas_openmesh INTERFACE ${OPENMESH_CORE_LIBRARY})
  list(APPEND libraries OpenMeshCore=${OPENMESH_CORE_LIBRARY})
endif()

# Not every system has CMake packages of these libraries, so their files are looked up and become
# targets. cmake/libatlasConfig.cmake.in makes the same targets for users of the installed library.
foreach(found IN LISTS libraries)
  string(REGEX MATCH "^([^=]*)=(.*)$" found "${found}")
  add_library(libatlas::${CMAKE_MATCH_1} UNKNOWN IMPORTED GLOBAL)
  set_target_properties(libatlas::${CMAKE_MATCH_1} PROPERTIES IMPORTED_LOCATION ${CMAKE_MATCH_2})
endforeach()
if(TARGET libatlas::draco)
  set_target_properties(libatlas::draco PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${DRACO_INCLUDE_DIR})
  set_target_properties(libatlas::webp PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${WEBP_INCLUDE_DIR})
endif()

if(LIBATLAS_BUILD_TESTS)
  find_package(GTest REQUIRED)            # libgtest-dev
  include(GoogleTest)
endif()
if(LIBATLAS_BUILD_BENCHMARKS)
  find_package(TBB REQUIRED)              # whose threads end before a process forks
  find_package(benchmark REQUIRED)        # libbenchmark-dev
endif()
if(LIBATLAS_BUILD_APPS OR LIBATLAS_BUILD_EXAMPLES)
  find_package(CLI11 REQUIRED)            # libcli11-dev: command lines
endif()
if(LIBATLAS_BUILD_EXAMPLES OR LIBATLAS_BUILD_TESTS OR LIBATLAS_TUNING)
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
