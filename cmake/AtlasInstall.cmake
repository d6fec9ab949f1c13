# The installed package: a library for each component, the public headers, a CMake package and files for
# pkg-config. The ATLAS BLAS owns the name libatlas.so on many systems, so the files are called
# libatlasgeo_COMPONENT; the package is libatlas.

# How each third-party target that a folder names is linked by those who use the installed libraries: by
# pkg-config as a package, or with an option. OpenImageIO is not among them: the module that needs it is
# loaded when needed (libatlas/image). Left out: what is headers only, and so ends at our own .cpp files.
set(ATLAS_LINKED TBB::tbb=tbb fmt::fmt=fmt ZLIB::ZLIB=zlib PNG::PNG=libpng JPEG::JPEG=libjpeg meshoptimizer::meshoptimizer=-lmeshoptimizer
                 libatlas::draco=-ldraco libatlas::webp=libwebp libatlas::mpfr=mpfr libatlas::gmp=gmp libatlas::OpenMeshCore=-lOpenMeshCore
                 Threads::Threads=-lpthread ${CMAKE_DL_LIBS}=-l${CMAKE_DL_LIBS}
                 glfw=glfw3 PkgConfig::EPOXY=epoxy PkgConfig::EGL=egl PkgConfig::IMGUI=imgui)
set(ATLAS_HEADERS_ONLY glm::glm fmt::fmt-header-only nlohmann_json::nlohmann_json atlas_options)
# Targets of the build that stand for headers and the libraries behind them.
set(ATLAS_STANDS_FOR_CGAL::CGAL libatlas::mpfr libatlas::gmp)
set(ATLAS_STANDS_FOR_atlas_openmesh libatlas::OpenMeshCore)

# atlas_component(NAME folder...): the folders, the library libatlasgeo_NAME of all their objects, and what
# is installed of them. It links the library of the component before it.
function(atlas_component name)
  if(NOT name IN_LIST ATLAS_COMPONENTS)
    return()
  endif()
  set(objects "")
  set(libraries "")
  foreach(module IN LISTS ARGN)
    add_subdirectory(${module})
    list(APPEND objects $<TARGET_OBJECTS:atlas_${module}>)
    get_target_property(linked atlas_${module} LINK_LIBRARIES)
    foreach(library IN LISTS linked)
      string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" library "${library}")
      if(DEFINED ATLAS_STANDS_FOR_${library})
        list(APPEND libraries ${ATLAS_STANDS_FOR_${library}})
      elseif(";${ATLAS_LINKED}" MATCHES ";${library}=")
        list(APPEND libraries ${library})
      elseif(NOT library IN_LIST ATLAS_HEADERS_ONLY AND NOT library MATCHES "^atlas_")
        message(FATAL_ERROR "cmake/AtlasInstall.cmake does not know how an installed libatlas links "
                            "${library} (folder ${module}): add it there")
      endif()
    endforeach()
    if(LIBATLAS_INSTALL)
      atlas_install_headers(${module})
    endif()
  endforeach()
  if(name STREQUAL uv)
    list(APPEND libraries Threads::Threads)
  endif()
  list(REMOVE_DUPLICATES libraries)
  set(target libatlas_${name})
  add_library(${target} ${objects})
  add_library(libatlas::${name} ALIAS ${target})
  target_link_libraries(${target} PRIVATE ${libraries})
  list(FIND ATLAS_COMPONENTS ${name} before)
  set(below "")
  if(before GREATER 0)
    math(EXPR before "${before} - 1")
    list(GET ATLAS_COMPONENTS ${before} below)
    target_link_libraries(${target} PUBLIC libatlas_${below})
  endif()
  target_include_directories(${target} INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                 $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES OUTPUT_NAME atlasgeo_${name} EXPORT_NAME ${name} LINKER_LANGUAGE CXX
                        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  if(LIBATLAS_RUNPATH)  # the libraries lie side by side
    set_target_properties(${target} PROPERTIES INSTALL_RPATH $ORIGIN)
  endif()
  if(LIBATLAS_INSTALL)
    install(TARGETS ${target} EXPORT libatlasTargets
            LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development
            ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
    atlas_install_pkgconfig("${name}" "${below}" "${libraries}")
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

# The image module lies beside the library; a program that holds the library itself looks there. The
# loader looks in the system's folders anyway, and distributions refuse run paths to them, so
# libatlasConfig.cmake and the files for pkg-config leave them out there.
set(LIBATLAS_HAS_RUNPATH OFF)
if(LIBATLAS_RUNPATH AND NOT BUILD_SHARED_LIBS AND NOT CMAKE_SKIP_RPATH AND NOT CMAKE_SKIP_INSTALL_RPATH)
  set(LIBATLAS_HAS_RUNPATH ON)
endif()

# Whoever links a static library links what it needs, too. `component` is empty for the whole library.
function(atlas_install_pkgconfig component below libraries)
  set(PC_NAME libatlas)
  set(PC_REQUIRES "")
  set(PC_LIBS "")
  if(component)
    set(PC_NAME libatlas-${component})
    set(PC_LIBS "-L\${libdir} -latlasgeo_${component}")
  endif()
  if(below)
    set(PC_REQUIRES libatlas-${below})
  endif()
  set(packages "")
  set(options "")
  foreach(library IN LISTS libraries)
    string(REGEX REPLACE "^.*;${library}=([^;]*).*$" "\\1" linked ";${ATLAS_LINKED}")
    if(library STREQUAL libatlas::OpenMeshCore)
      get_filename_component(folder ${OPENMESH_CORE_LIBRARY} DIRECTORY)
      if(NOT folder IN_LIST CMAKE_CXX_IMPLICIT_LINK_DIRECTORIES)
        string(APPEND options " -L${folder}")
      endif()
    endif()
    if(linked MATCHES "^-")
      string(APPEND options " ${linked}")
    else()
      string(APPEND packages " ${linked}")
    endif()
  endforeach()
  if(BUILD_SHARED_LIBS)
    set(PC_PRIVATE "Requires.private:${packages}\nLibs.private:${options}")
  else()
    set(PC_PRIVATE "")
    string(APPEND PC_REQUIRES "${packages}")
    string(APPEND PC_LIBS "${options}")
    if(component STREQUAL "reading" AND LIBATLAS_HAS_RUNPATH
       AND NOT CMAKE_INSTALL_FULL_LIBDIR IN_LIST CMAKE_CXX_IMPLICIT_LINK_DIRECTORIES)
      string(APPEND PC_LIBS " -Wl,-rpath,\${libdir}")
    endif()
  endif()
  file(RELATIVE_PATH PC_UP /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
  string(REGEX REPLACE "/$" "" PC_UP ${PC_UP})
  configure_file(${PROJECT_SOURCE_DIR}/cmake/libatlas.pc.in ${PROJECT_BINARY_DIR}/${PC_NAME}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${PC_NAME}.pc
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endfunction()

# The target libatlas::libatlas of all components but the player's, the package for CMake, the file for
# pkg-config, and the licences.
function(atlas_install_package)
  set(components ${ATLAS_COMPONENTS})
  list(REMOVE_ITEM components view)
  list(GET components -1 last)
  add_library(libatlas INTERFACE)
  target_link_libraries(libatlas INTERFACE libatlas_${last})
  add_library(libatlas::libatlas ALIAS libatlas)
  if(NOT LIBATLAS_INSTALL)
    return()
  endif()
  atlas_install_pkgconfig("" ${last} "")
  include(CMakePackageConfigHelpers)
  set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/libatlas)
  set(LIBATLAS_IS_STATIC ON)
  if(BUILD_SHARED_LIBS)
    set(LIBATLAS_IS_STATIC OFF)
  endif()
  install(TARGETS libatlas EXPORT libatlasTargets COMPONENT development)
  install(EXPORT libatlasTargets NAMESPACE libatlas:: DESTINATION ${package_dir} COMPONENT development)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/libatlasConfig.cmake.in
                                ${PROJECT_BINARY_DIR}/libatlasConfig.cmake
                                INSTALL_DESTINATION ${package_dir} PATH_VARS CMAKE_INSTALL_LIBDIR)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/libatlasConfigVersion.cmake
                                   COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/libatlasConfig.cmake
                ${PROJECT_BINARY_DIR}/libatlasConfigVersion.cmake
          DESTINATION ${package_dir} COMPONENT development)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/THIRD_PARTY.md
          DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT development)
endfunction()
