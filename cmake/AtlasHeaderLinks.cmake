# For other targets than this system: the packages of headers that the component uv needs come from the
# system, whose other headers must stay unseen, since its C library is not that of the target. So each
# package is a link in a folder of our own, and a target that says nothing. Include this before
# add_subdirectory() of the library.
set(headers ${CMAKE_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${headers})
foreach(package "glm glm/glm.hpp glm::glm" "fmt fmt/format.h fmt::fmt-header-only"
                "Eigen3 Eigen/Core Eigen3::Eigen")
  string(REGEX MATCH "^(.*) ((.*)/.*) (.*)$" package ${package})
  set(name ${CMAKE_MATCH_1})
  set(folder ${CMAKE_MATCH_3})
  file(WRITE ${headers}/${name}Config.cmake "add_library(${CMAKE_MATCH_4} INTERFACE IMPORTED GLOBAL)\n")
  find_path(${name}_PARENT ${CMAKE_MATCH_2} REQUIRED NO_CMAKE_FIND_ROOT_PATH NO_DEFAULT_PATH
            PATHS /usr/include /usr/include/eigen3 /usr/local/include /usr/local/include/eigen3)
  file(CREATE_LINK ${${name}_PARENT}/${folder} ${headers}/${folder} SYMBOLIC)
  set(${name}_DIR ${headers})
endforeach()
include_directories(SYSTEM ${headers})
add_compile_definitions(FMT_HEADER_ONLY)
