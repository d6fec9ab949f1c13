# What programs are installed with, and Debian packages of it all: `cpack -G DEB` in the build folder.

# atlas_install_program(NAME): the program; with LIBATLAS_MANUAL also its manual page and what bash and zsh
# complete, all made from its --help.
function(atlas_install_program name)
  install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
  if(NOT LIBATLAS_MANUAL)
    return()
  endif()
  find_program(HELP2MAN help2man REQUIRED)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  set(manual ${CMAKE_CURRENT_BINARY_DIR}/${name}.1)
  set(completion ${CMAKE_CURRENT_BINARY_DIR}/completion)
  add_custom_command(OUTPUT ${manual} ${completion}/${name} ${completion}/_${name}
    COMMAND ${HELP2MAN} --no-info --no-discard-stderr --output=${manual} $<TARGET_FILE:${name}>
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/cmake/completion.py $<TARGET_FILE:${name}> ${completion}
    DEPENDS ${name} ${PROJECT_SOURCE_DIR}/cmake/completion.py VERBATIM)
  add_custom_target(manual-${name} ALL DEPENDS ${manual})
  install(FILES ${manual} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs)
  install(FILES ${completion}/${name} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
          COMPONENT programs)
  install(FILES ${completion}/_${name} DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
          COMPONENT programs)
endfunction()

if(NOT PROJECT_IS_TOP_LEVEL)
  return()
endif()
set(abi ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(CPACK_PACKAGE_NAME libatlas)
set(CPACK_PACKAGE_CONTACT "The libatlas authors <maintainers@libatlas.invalid>")
set(CPACK_PACKAGE_VENDOR "The libatlas authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "texture atlases of triangle meshes")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL library development programs)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libatlasgeo${abi})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "charts, uvs and packing for C, and a module that reads images")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libatlasgeo-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libatlasgeo${abi} (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "headers, libraries for C++, packages for CMake and pkg-config")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME libatlas-tools)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_DEPENDS "libatlasgeo${abi} (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_PROGRAMS_DESCRIPTION "atlas-export, atlas-pack and atlas-play")
include(CPack)
