# The installed package: one library out of all folders, the public headers, a CMake package and a
# pkg-config file. The ATLAS BLAS owns the name libatlas.so on many systems, so the files are called
# libatlasgeo; the package is libatlas.

# How each third-party target that a folder names is linked by those who use the installed library.
# OpenImageIO is not among them: the module that needs it is loaded when needed (libatlas/image).
# Left out: what is headers only, and so ends at our own .cpp files.
set(ATLAS_LINK_AS_TARGET TBB::tbb fmt::fmt ZLIB::ZLIB PNG::PNG JPEG::JPEG meshoptimizer::meshoptimizer glfw PkgConfig::EPOXY PkgConfig::EGL PkgConfig::IMGUI)
set(ATLAS_HEADERS_ONLY glm::glm Eigen3::Eigen nlohmann_json::nlohmann_json atlas_options)

# atlas_gather(TARGET OUTPUT_NAME module...): a library of all the modules' objects.
function(atlas_gather target output)
  set(objects "")
  set(libraries "")
  foreach(module IN LISTS ARGN)
    list(APPEND objects $<TARGET_OBJECTS:atlas_${module}>)
    get_target_property(linked atlas_${module} LINK_LIBRARIES)
    foreach(library IN LISTS linked)
      string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" library "${library}")
      if(library IN_LIST ATLAS_LINK_AS_TARGET)
        list(APPEND libraries ${library})
      elseif(library STREQUAL CGAL::CGAL)
        list(APPEND libraries libatlas::mpfr libatlas::gmp)
      elseif(library STREQUAL atlas_openmesh)
        list(APPEND libraries libatlas::OpenMeshCore)
      elseif(library STREQUAL CMAKE_DL_LIBS OR library MATCHES "^libatlas::")
        list(APPEND libraries ${library})
      elseif(NOT library IN_LIST ATLAS_HEADERS_ONLY AND NOT library MATCHES "^atlas_")
        message(FATAL_ERROR "cmake/AtlasInstall.cmake does not know how an installed libatlas links "
                            "${library} (folder ${module}): add it there")
      endif()
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES libraries)
  add_library(${target} ${objects})
  target_link_libraries(${target} PRIVATE ${libraries} Threads::Threads)
  target_include_directories(${target} INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                 $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${output} LINKER_LANGUAGE CXX
                        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  if(LIBATLAS_INSTALL)
    install(TARGETS ${target} EXPORT libatlasTargets COMPONENT development
            LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  elseif(BUILD_SHARED_LIBS)  # which installed programs of the parent project need
    install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} NAMELINK_SKIP)
  endif()
endfunction()

# A header is public unless its first line starts with "// Internal"; tests/layering holds the public
# ones to including nothing else.
function(atlas_install_headers module)
  file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${module}/*.h)
  foreach(header IN LISTS headers)
    file(STRINGS ${header} first LIMIT_COUNT 1)
    if(NOT first MATCHES "^// Internal")
      install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/libatlas/${module}
              COMPONENT development)
    endif()
  endforeach()
endfunction()

function(atlas_install_package)
  get_property(modules GLOBAL PROPERTY ATLAS_MODULES)
  set(view ${modules})
  list(FILTER view INCLUDE REGEX "^view$")
  list(REMOVE_ITEM modules view)
  atlas_gather(libatlas atlasgeo ${modules})
  set_target_properties(libatlas PROPERTIES EXPORT_NAME libatlas)
  add_library(libatlas::libatlas ALIAS libatlas)
  if(view)
    atlas_gather(libatlas_view atlasgeo_view ${view})
    target_link_libraries(libatlas_view PUBLIC libatlas)
    set_target_properties(libatlas_view PROPERTIES EXPORT_NAME view)
    add_library(libatlas::view ALIAS libatlas_view)
  endif()
  if(LIBATLAS_INSTALL)
    foreach(module IN LISTS modules view)
      atlas_install_headers(${module})
    endforeach()
    atlas_install_descriptions("${view}")
  endif()
endfunction()

# Installs the package for CMake, the one for pkg-config, and the licences.
function(atlas_install_descriptions view)
  include(CMakePackageConfigHelpers)
  set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/libatlas)
  set(LIBATLAS_HAS_VIEW OFF)
  if(view)
    set(LIBATLAS_HAS_VIEW ON)
  endif()
  set(LIBATLAS_IS_STATIC ON)
  if(BUILD_SHARED_LIBS)
    set(LIBATLAS_IS_STATIC OFF)
  endif()
  # The image module lies beside the library; a program that holds the library itself looks there. The
  # loader looks in the system's folders anyway, and distributions refuse run paths to them, so
  # libatlasConfig.cmake and the pkg-config file leave them out there.
  set(LIBATLAS_HAS_RUNPATH OFF)
  if(LIBATLAS_RUNPATH AND NOT BUILD_SHARED_LIBS AND NOT CMAKE_SKIP_RPATH AND NOT CMAKE_SKIP_INSTALL_RPATH)
    set(LIBATLAS_HAS_RUNPATH ON)
  endif()
  install(EXPORT libatlasTargets NAMESPACE libatlas:: DESTINATION ${package_dir} COMPONENT development)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/libatlasConfig.cmake.in
                                ${PROJECT_BINARY_DIR}/libatlasConfig.cmake
                                INSTALL_DESTINATION ${package_dir} PATH_VARS CMAKE_INSTALL_LIBDIR)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/libatlasConfigVersion.cmake
                                   COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/libatlasConfig.cmake
                ${PROJECT_BINARY_DIR}/libatlasConfigVersion.cmake
          DESTINATION ${package_dir} COMPONENT development)

  # Whoever links a static library links what it needs, too.
  set(needed_packages "tbb fmt zlib libpng libjpeg mpfr gmp")
  set(needed_libraries "-lOpenMeshCore -ldraco -lwebp -lmeshoptimizer -lpthread -ldl")
  get_filename_component(openmesh_dir ${OPENMESH_CORE_LIBRARY} DIRECTORY)
  if(NOT openmesh_dir IN_LIST CMAKE_CXX_IMPLICIT_LINK_DIRECTORIES)
    string(PREPEND needed_libraries "-L${openmesh_dir} ")
  endif()
  if(BUILD_SHARED_LIBS)
    set(PC_PRIVATE "Requires.private: ${needed_packages}\nLibs.private: ${needed_libraries}")
    set(PC_PUBLIC "")
  else()
    set(PC_PRIVATE "Requires: ${needed_packages}")
    set(PC_PUBLIC " ${needed_libraries}")
    if(LIBATLAS_HAS_RUNPATH AND NOT CMAKE_INSTALL_FULL_LIBDIR IN_LIST CMAKE_CXX_IMPLICIT_LINK_DIRECTORIES)
      string(APPEND PC_PUBLIC " -Wl,-rpath,\${libdir}")
    endif()
  endif()
  file(RELATIVE_PATH PC_UP /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
  string(REGEX REPLACE "/$" "" PC_UP ${PC_UP})
  configure_file(${PROJECT_SOURCE_DIR}/cmake/libatlas.pc.in ${PROJECT_BINARY_DIR}/libatlas.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/libatlas.pc
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/THIRD_PARTY.md
          DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT development)
endfunction()
