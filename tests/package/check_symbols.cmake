# Run by ctest with NM and FILES, the libraries that were built (separated by commas). Refuses symbols
# of packages that cmake/AtlasTargets.cmake compiles into namespaces of the library's own: a program
# that uses such a package itself would share them, although it compiled them with other flags.
cmake_minimum_required(VERSION 3.22)
# As the names of namespaces are mangled, with their lengths, in types and functions alike.
set(private "(5Eigen|4CGAL|8nlohmann|8tinygltf)")
string(REPLACE "," ";" files "${FILES}")
foreach(file IN LISTS files)
  execute_process(COMMAND ${NM} --defined-only --extern-only ${file}
                  RESULT_VARIABLE result OUTPUT_VARIABLE symbols ERROR_VARIABLE errors)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${NM} ${file} failed (${result}):\n${errors}")
  endif()
  if(NOT symbols MATCHES "_ZN")
    message(FATAL_ERROR "${file} defines no C++ function, so nothing was checked")
  endif()
  if(symbols MATCHES "[^0-9]${private}[^\n]*")
    message(FATAL_ERROR "${file} defines a symbol of a package that programs may use, too (its sources "
                        "need the definitions of atlas_options): ...${CMAKE_MATCH_0}")
  endif()
endforeach()
