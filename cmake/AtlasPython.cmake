# Debian's Python first, since it sees Debian's packages; LIBATLAS_PYTHON is empty where there is none.
find_program(LIBATLAS_PYTHON NAMES python3 HINTS /usr/bin NO_CMAKE_ENVIRONMENT_PATH NO_SYSTEM_ENVIRONMENT_PATH)
if(NOT LIBATLAS_PYTHON)
  find_program(LIBATLAS_PYTHON NAMES python3)
endif()
