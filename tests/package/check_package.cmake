# Run by ctest with SOURCE, BUILD, GENERATOR, CXX and FLAGS set, and the files OPENMESH and DRACO.
cmake_minimum_required(VERSION 3.22)
set(prefix ${BUILD}/tests/package/prefix)
file(REMOVE_RECURSE ${prefix} ${BUILD}/tests/package/minimal)

include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

foreach(component library development)
  run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix} --component ${component})
endforeach()

# Nothing may be called libatlas.so or libatlas.a, which belong to the ATLAS BLAS. Internal headers
# must not be installed.
file(GLOB_RECURSE installed RELATIVE ${prefix} ${prefix}/*)
foreach(file IN LISTS installed)
  if(file MATCHES "/libatlas\\.(so|a)")
    message(FATAL_ERROR "${file} collides with the ATLAS BLAS")
  endif()
  if(file MATCHES "_bridge\\.h$")
    message(FATAL_ERROR "${file} is internal but installed")
  endif()
endforeach()

foreach(name LICENSE THIRD_PARTY.md)
  file(GLOB found ${prefix}/share/doc/*/${name})
  if(NOT found)
    message(FATAL_ERROR "${name} is not installed")
  endif()
endforeach()

# Uses the package with find_package.
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/examples/minimal -B ${BUILD}/tests/package/minimal
    -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${FLAGS})
run(${CMAKE_COMMAND} --build ${BUILD}/tests/package/minimal)
set(out ${BUILD}/tests/package/minimal)
run(${out}/sprites)
if(NOT output MATCHES "5000 sprites, [1-9][0-9]* pages .*on 4 pages at 0\\.[3-9]")
  message(FATAL_ERROR "sprites printed: ${output}")
endif()
run(${out}/bake ${out}/page.png)
if(NOT output MATCHES "texels [67][0-9][0-9][0-9][0-9][0-9] -> [1-9][0-9]*, page .*, [4-9][0-9]\\.[0-9] dB" OR NOT EXISTS ${out}/page.png)
  message(FATAL_ERROR "bake printed: ${output}")
endif()
foreach(extension wrl glb)
  run(${out}/export ${out}/floor.${extension})
  if(NOT output MATCHES "80000 triangles -> [1-9][0-9]*, 1 page" OR NOT EXISTS ${out}/floor.${extension})
    message(FATAL_ERROR "export printed: ${output}")
  endif()
endforeach()
run(${out}/unwrap)
if(NOT output MATCHES "2304 triangles, [1-9][0-9]* charts, stretch 1\\.[0-9]+")
  message(FATAL_ERROR "unwrap printed: ${output}")
endif()
message(STATUS "find_package: ${output}")
# The mesh for this one has no light and two triangles a side, as a newcomer's first file may.
file(WRITE ${out}/cube.obj "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n")
file(REMOVE_RECURSE ${out}/steps)
run(${out}/stages ${out}/cube.obj ${out}/steps)
if(NOT output MATCHES "12 triangles, [1-6] charts.*PSNR [4-9][0-9].*simplify +12 triangles")
  message(FATAL_ERROR "stages printed: ${output}")
endif()
foreach(name charts.obj layout.svg page.png world.glb)
  if(NOT EXISTS ${out}/steps/${name})
    message(FATAL_ERROR "stages wrote no ${name}")
  endif()
endforeach()

# Where libraries have prefixes of their own. A shared libatlas brings them itself.
file(GLOB_RECURSE archive ${prefix}/*/libatlasgeo_uv.a)
if(archive)
  set(elsewhere ${BUILD}/tests/package/elsewhere)
  file(REMOVE_RECURSE ${elsewhere} ${BUILD}/tests/package/minimal_elsewhere)
  foreach(library OPENMESH DRACO)
    get_filename_component(folder ${${library}} DIRECTORY)
    get_filename_component(name ${${library}} NAME)
    file(GLOB files ${folder}/${name}*)
    file(COPY ${files} DESTINATION ${elsewhere}/lib)
  endforeach()
  run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/examples/minimal
      -B ${BUILD}/tests/package/minimal_elsewhere "-DCMAKE_PREFIX_PATH=${prefix}\\;${elsewhere}"
      -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${FLAGS})
  run(${CMAKE_COMMAND} --build ${BUILD}/tests/package/minimal_elsewhere --target unwrap --verbose)
  foreach(library OPENMESH DRACO)
    get_filename_component(name ${${library}} NAME)
    if(NOT output MATCHES "tests/package/elsewhere/lib/${name}")
      message(FATAL_ERROR "${name} is not linked where it lies:\n${output}")
    endif()
  endforeach()
  run(${BUILD}/tests/package/minimal_elsewhere/unwrap)
endif()

# What docs/library.md shows, as it stands there, with warnings as errors. Brackets and semicolons
# would be lists to CMake, so the page is cut at its fences by position.
file(READ ${SOURCE}/docs/library.md page)
set(snippets 0)
while(TRUE)
  string(FIND "${page}" "```cpp\n" begin)
  if(begin EQUAL -1)
    break()
  endif()
  math(EXPR begin "${begin} + 7")
  string(SUBSTRING "${page}" ${begin} -1 page)
  string(FIND "${page}" "```" end)
  string(SUBSTRING "${page}" 0 ${end} snippet)
  string(SUBSTRING "${page}" ${end} -1 page)
  string(SUBSTRING "${page}" 3 -1 page)
  math(EXPR snippets "${snippets} + 1")
  file(WRITE ${BUILD}/tests/package/snippet_${snippets}.cpp "${snippet}")
  run(${CXX} -std=c++20 -Wall -Wextra -Werror -fsyntax-only -I${prefix}/include
      ${BUILD}/tests/package/snippet_${snippets}.cpp)
endwhile()
if(snippets LESS 6)
  message(FATAL_ERROR "docs/library.md shows ${snippets} pieces of code")
endif()

# The first lines of the README are statements after an include.
file(READ ${SOURCE}/README.md page)
string(REGEX MATCH "```cpp\n(#include [^\n]*\n)([^`]*)```" found "${page}")
file(WRITE ${BUILD}/tests/package/readme.cpp "${CMAKE_MATCH_1}
void use(const std::vector<std::uint32_t>&, const std::vector<atlas::Vec2f>&, const std::vector<std::uint32_t>&);
void unwrap(const std::vector<atlas::Vec3f>& positions, const std::vector<std::uint32_t>& indices);
void unwrap(const std::vector<atlas::Vec3f>& positions, const std::vector<std::uint32_t>& indices) {
${CMAKE_MATCH_2}}
")
run(${CXX} -std=c++20 -Wall -Wextra -Werror -fsyntax-only -I${prefix}/include ${BUILD}/tests/package/readme.cpp)

# Compiles all public headers together: no two may define the same name.
file(GLOB_RECURSE headers RELATIVE ${prefix}/include ${prefix}/include/*.h)
list(TRANSFORM headers REPLACE "(.+)" "#include <\\1>\n")
list(JOIN headers "" together)
file(WRITE ${BUILD}/tests/package/together.cpp "${together}")
run(${CXX} -std=c++20 -Wall -Wextra -Werror -fsyntax-only -I${prefix}/include
    ${BUILD}/tests/package/together.cpp)

# Uses the project with add_subdirectory, which must not require packages for programs and tests
# only.
file(REMOVE_RECURSE ${BUILD}/tests/package/parent)
file(WRITE ${BUILD}/tests/package/parent/CMakeLists.txt "
cmake_minimum_required(VERSION 3.22)
project(parent LANGUAGES CXX)
add_subdirectory(${SOURCE} libatlas)
add_executable(unwrap ${SOURCE}/examples/minimal/unwrap.cpp)
target_link_libraries(unwrap PRIVATE libatlas::libatlas)
")
set(disabled "")
foreach(package GTest benchmark CLI11 embree glfw3)
  list(APPEND disabled -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${BUILD}/tests/package/parent -B ${BUILD}/tests/package/parent/build
    -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${FLAGS} ${disabled})

# A project that hides symbols, joins sources, compiles them as games are, gathers libraries in one folder,
# and makes a package itself, which therefore cannot be part of an installation.
set(strict ${BUILD}/tests/package/strict_parent)
file(REMOVE_RECURSE ${strict})
file(WRITE ${strict}/CMakeLists.txt "
cmake_minimum_required(VERSION 3.22)
project(strict_parent LANGUAGES CXX)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_UNITY_BUILD ON)
set(CMAKE_CXX_FLAGS \"\${CMAKE_CXX_FLAGS} -ffast-math\")
add_compile_options(-fno-exceptions -fno-rtti)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY \${CMAKE_BINARY_DIR}/gathered)
add_library(my_zlib INTERFACE)
add_library(ZLIB::ZLIB ALIAS my_zlib)
add_subdirectory(${SOURCE} libatlas)
")
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${strict} -B ${strict}/build
    -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${FLAGS} -DLIBATLAS_UNITY=OFF ${disabled})
file(READ ${strict}/build/compile_commands.json commands)
# An option that is taken back later is without effect.
foreach(option fast-math exceptions rtti)
  string(REGEX REPLACE "-f(no-)?${option}[^\n]* -f(no-)?${option} " "-f\\2${option} " commands "${commands}")
endforeach()
if(commands MATCHES "hidden|unity_|-ffast-math|-fno-exceptions|-fno-rtti" OR
   NOT commands MATCHES "LIBATLAS_BUILT_IN=[^ ]*gathered")
  message(FATAL_ERROR "a parent's settings reach libatlas: see ${strict}/build/compile_commands.json")
endif()
file(GLOB_RECURSE rules ${strict}/build/libatlas/*cmake_install.cmake)
foreach(file IN LISTS rules)
  file(READ ${file} text)
  if(text MATCHES "include/libatlas|libatlasConfig|libatlas\\.pc")
    message(FATAL_ERROR "a parent's installation holds the package: ${file}")
  endif()
endforeach()

# Programs get the library's folder as a run path, but not where the system looks anyway or CMake is to
# set none.
foreach(wanted "" "set(CMAKE_SKIP_RPATH ON)" "list(APPEND CMAKE_CXX_IMPLICIT_LINK_DIRECTORIES \${folder})")
  set(consumer ${BUILD}/tests/package/run_path)
  file(REMOVE_RECURSE ${consumer})
  file(WRITE ${consumer}/CMakeLists.txt "
cmake_minimum_required(VERSION 3.22)
project(run_path LANGUAGES CXX)
file(GLOB module ${prefix}/*/libatlasgeo_images-*.so ${prefix}/*/*/libatlasgeo_images-*.so)
get_filename_component(folder \${module} DIRECTORY)
${wanted}
find_package(libatlas REQUIRED)
find_package(libatlas REQUIRED)  # twice, as by two folders of a project
get_target_property(options libatlas::reading INTERFACE_LINK_OPTIONS)
message(STATUS \"options <\${options}> folder <\${folder}>\")
")
  run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${consumer} -B ${consumer}/build -DCMAKE_PREFIX_PATH=${prefix}
      -DCMAKE_CXX_COMPILER=${CXX})
  string(REGEX MATCH "options <([^>]*)> folder <([^>]*)>" output "${output}")
  set(expected options-NOTFOUND)
  if(archive AND wanted STREQUAL "")
    set(expected "LINKER:-rpath,${CMAKE_MATCH_2}")
  endif()
  if(NOT CMAKE_MATCH_1 STREQUAL expected)
    message(FATAL_ERROR "run path with '${wanted}':\n${output}")
  endif()
endforeach()

# Each part can be left out, and so can run paths.
set(without_APPS -DLIBATLAS_RUNPATH=OFF)
set(without_EXAMPLES -DCMAKE_INSTALL_PREFIX=/usr)
foreach(part APPS EXAMPLES)
  file(REMOVE_RECURSE ${BUILD}/tests/package/part)
  run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE} -B ${BUILD}/tests/package/part
      -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${FLAGS} -DLIBATLAS_BUILD_${part}=OFF ${without_${part}})
  file(READ ${BUILD}/tests/package/part/libatlas-reading.pc text)
  if(text MATCHES "rpath")
    message(FATAL_ERROR "libatlas-reading.pc sets a run path with ${without_${part}}:\n${text}")
  endif()
endforeach()

# Uses the package with pkg-config.
file(GLOB_RECURSE pc ${prefix}/*/libatlas-reading.pc)
get_filename_component(pc_dir ${pc} DIRECTORY)
file(READ ${pc} text)
if(text MATCHES "//" OR (archive AND NOT text MATCHES "-Wl,-rpath,\\\${libdir}"))
  message(FATAL_ERROR "${pc}:\n${text}")
endif()
run(${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${pc_dir} pkg-config --cflags --libs libatlas)
separate_arguments(link UNIX_COMMAND "${output}")
separate_arguments(flags UNIX_COMMAND "${FLAGS}")
run(${CXX} -std=c++20 ${flags} ${SOURCE}/examples/minimal/unwrap.cpp
    -o ${BUILD}/tests/package/unwrap_by_pkg_config ${link})
run(${BUILD}/tests/package/unwrap_by_pkg_config)
if(NOT output MATCHES "2304 triangles")
  message(FATAL_ERROR "unwrap by pkg-config printed: ${output}")
endif()

# Uses the component uv alone, by find_package and by pkg-config. None of the packages that the others
# need may be looked for, linked or loaded.
set(uv ${BUILD}/tests/package/uv)
file(REMOVE_RECURSE ${uv})
file(WRITE ${uv}/CMakeLists.txt "
cmake_minimum_required(VERSION 3.22)
project(uv LANGUAGES CXX)
find_package(libatlas REQUIRED COMPONENTS uv)
add_executable(unwrap ${SOURCE}/examples/minimal/unwrap.cpp)
target_link_libraries(unwrap PRIVATE libatlas::uv)
")
set(others "")
foreach(package PkgConfig CGAL nlohmann_json meshoptimizer ZLIB fmt GTest benchmark CLI11 embree glfw3)
  list(APPEND others -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${uv} -B ${uv}/build -DCMAKE_PREFIX_PATH=${prefix}
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${FLAGS} ${others})
run(${CMAKE_COMMAND} --build ${uv}/build)
run(${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${pc_dir} pkg-config --cflags --libs libatlas-uv)
separate_arguments(uv_link UNIX_COMMAND "${output}")
run(${CXX} -std=c++20 ${flags} ${SOURCE}/examples/minimal/unwrap.cpp -o ${uv}/unwrap ${uv_link})
foreach(program ${uv}/unwrap ${uv}/build/unwrap)
  run(${program})
  if(NOT output MATCHES "2304 triangles")
    message(FATAL_ERROR "${program} printed: ${output}")
  endif()
  run(ldd ${program})
  string(REGEX REPLACE "[^\n]*(linux-vdso|ld-linux[^ ]*|lib(c|m|stdc\\+\\+|gcc_s|tbb|atlasgeo_uv))\\.so[^\n]*\n"
         "" beyond "${output}")
  if(NOT beyond STREQUAL "" AND NOT FLAGS MATCHES "-fsanitize")
    message(FATAL_ERROR "${program} loads more than it needs:\n${beyond}")
  endif()
endforeach()
if(archive AND NOT FLAGS MATCHES "-fsanitize")
  run(strip ${uv}/unwrap)
  file(SIZE ${uv}/unwrap bytes)
  if(bytes GREATER 3000000)
    message(FATAL_ERROR "a program that unwraps has ${bytes} bytes, more than 3 MB")
  endif()
endif()
# And with add_subdirectory, where only its sources are built.
file(WRITE ${uv}/CMakeLists.txt "
cmake_minimum_required(VERSION 3.22)
project(uv LANGUAGES CXX)
set(LIBATLAS_COMPONENTS uv)
add_subdirectory(${SOURCE} libatlas)
add_executable(unwrap ${SOURCE}/examples/minimal/unwrap.cpp)
target_link_libraries(unwrap PRIVATE libatlas::uv)
")
list(REMOVE_ITEM others -DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON)  # its headers alone
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${uv} -B ${uv}/sources -DLIBATLAS_UNITY=OFF
    -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${FLAGS} ${others})
file(READ ${uv}/sources/compile_commands.json commands)
if(NOT commands MATCHES "/unwrap/unwrap\\.cpp" OR commands MATCHES "/(image|scene|bake|exporters)/[a-z_]+\\.cpp")
  message(FATAL_ERROR "LIBATLAS_COMPONENTS=uv builds the wrong sources: ${uv}/sources/compile_commands.json")
endif()

# Reads and writes image files. Their module is found where the library was installed.
file(GLOB_RECURSE module ${prefix}/*/libatlasgeo_images-*.so)
if(NOT module)
  message(FATAL_ERROR "the image module is not installed")
endif()
file(WRITE ${BUILD}/tests/package/image.cpp [[
#include <cstdio>
#include "libatlas/image/image_io.h"
int main(int, char** argument) {
  atlas::Image8 image(3, 2, 1);
  image.texels = {1, 2, 3, 4, 5, 6};
  const atlas::Status written = atlas::write_png(argument[1], image, {});
  const auto read = atlas::read_image8(argument[1]);
  if (!written.ok() || !read.ok()) return std::puts(written.message().c_str()), 1;
  return read->texels == image.texels ? 0 : 1;
}
]])
run(${CXX} -std=c++20 ${flags} ${BUILD}/tests/package/image.cpp -o ${BUILD}/tests/package/image ${link})
run(${BUILD}/tests/package/image ${BUILD}/tests/package/image.png)
# A program that reads no image loads none of the libraries for reading.
run(ldd ${BUILD}/tests/package/image)
if(output MATCHES "OpenImageIO")
  message(FATAL_ERROR "OpenImageIO is loaded at the start:\n${output}")
endif()
