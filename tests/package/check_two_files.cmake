# Run by ctest with SOURCE, OUT, PYTHON, CXX, CC and EIGEN set. Makes the release of two files. With
# LIBRARY_PROGRAM, the same program linked to the library, both are compiled and run, and every bit is
# compared, for each of the compilers in COMPILERS; else the syntax is checked.
cmake_minimum_required(VERSION 3.22)
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

run(${PYTHON} ${SOURCE}/scripts/two_files.py ${OUT})
file(WRITE ${OUT}/header_alone.c "#include \"libatlas.h\"\nint main(void) { return (int)(libatlas_version() == 0); }\n")
run(${CC} -std=c99 -Wall -Wextra -Werror -pedantic -fsyntax-only ${OUT}/header_alone.c)
if(NOT LIBRARY_PROGRAM)
  run(${CXX} -std=c++20 -fsyntax-only -I${EIGEN} ${OUT}/libatlas.cpp)
  return()
endif()
run(${LIBRARY_PROGRAM})
set(wanted "${output}")
foreach(compiler IN LISTS COMPILERS)
  set(program ${OUT}/uv_bits)
  run(${compiler} -std=c++20 -O2 -ffp-contract=off -DTWO_FILES -I${OUT} -I${EIGEN}
      ${SOURCE}/tests/package/uv_bits.cpp ${OUT}/libatlas.cpp -o ${program} -pthread)
  run(${program})
  if(NOT output STREQUAL wanted)
    message(FATAL_ERROR "${compiler}:\n${output}the library:\n${wanted}")
  endif()
endforeach()
