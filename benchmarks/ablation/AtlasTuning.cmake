# With LIBATLAS_TUNING, the folders of instrument.py are compiled from copies whose constants the
# environment can change. Plain builds know nothing of it.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
set(ATLAS_TUNED_FOLDERS param charts pack unwrap)
set(ATLAS_TUNED_SOURCES ${PROJECT_BINARY_DIR}/tuned)
execute_process(
  COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/benchmarks/ablation/instrument.py
          ${PROJECT_SOURCE_DIR} ${ATLAS_TUNED_SOURCES}
  COMMAND_ERROR_IS_FATAL ANY)
file(GLOB_RECURSE tuned_inputs CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/libatlas/param/* ${PROJECT_SOURCE_DIR}/libatlas/charts/*
     ${PROJECT_SOURCE_DIR}/libatlas/pack/* ${PROJECT_SOURCE_DIR}/libatlas/unwrap/*)
list(FILTER tuned_inputs INCLUDE REGEX "[.](h|cpp)$")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${tuned_inputs}
  ${PROJECT_SOURCE_DIR}/benchmarks/ablation/instrument.py ${PROJECT_SOURCE_DIR}/benchmarks/ablation/fixed_constants.txt
  ${PROJECT_SOURCE_DIR}/benchmarks/ablation/rules.txt)
