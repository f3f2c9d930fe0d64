# How everything in Hive is compiled: language level, warnings, sanitizers, and the functions that add a layer or a drone.
include(CTest)
include(GNUInstallDirs)
if(CMAKE_INSTALL_LIBDIR STREQUAL lib AND CMAKE_LIBRARY_ARCHITECTURE)  # Debian's folders of libraries, below any prefix
  set(CMAKE_INSTALL_LIBDIR lib/${CMAKE_LIBRARY_ARCHITECTURE})
endif()

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE RelWithDebInfo)
endif()

set(HIVE_SANITIZE "" CACHE STRING "sanitizers for the whole build, as for -fsanitize=")
option(HIVE_FUZZ "build the libFuzzer targets (needs clang)" OFF)

add_compile_definitions(HIVE_VERSION="${PROJECT_VERSION}" ASIO_STANDALONE ASIO_NO_DEPRECATED)
add_compile_options(-Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Werror=return-type)
if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES ccache AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  add_compile_options(-fpch-preprocess)  # else ccache cannot tell what a precompiled header brings
endif()
if(HIVE_SANITIZE)
  add_compile_options(-fsanitize=${HIVE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  # With these g++ takes half as long again. AddressSanitizer stops at most of what they find, and the fuzz targets, which clang compiles,
  # have them all.
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    add_compile_options(-fno-sanitize=null,object-size,vptr,alignment,pointer-overflow,return,nonnull-attribute,returns-nonnull-attribute)
  endif()
  add_link_options(-fsanitize=${HIVE_SANITIZE})
endif()
if(HIVE_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

find_package(Threads REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(CLI11 REQUIRED)
find_package(spdlog REQUIRED)
# Its headers alone: a libhive that needs no libspdlog and no libfmt also loads on other distributions (the wheel).
add_library(hive_spdlog INTERFACE)
target_compile_definitions(hive_spdlog INTERFACE SPDLOG_FMT_EXTERNAL FMT_HEADER_ONLY)
find_package(OpenSSL 3.0 REQUIRED)

# Sources of one target are compiled a few at a time: most of the time goes into the headers of json and CLI11.
function(hive_batches target size)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${size})
endfunction()

# Code that waits for drones and programs, not for the processor: optimizing it more takes a third longer to compile and gains nothing.
function(hive_optimize_little)
  foreach(target ${ARGN})
    target_compile_options(${target} PRIVATE $<$<CONFIG:RelWithDebInfo,Release>:-O1>)
  endforeach()
endfunction()

# Headers that many executables begin with, compiled once: they take them by REUSE_FROM. The target that holds them is compiled as
# executables are, -fPIE, or else they could not.
function(hive_common_headers target)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  target_compile_options(${target} PRIVATE -fPIE)
  target_precompile_headers(${target} PRIVATE ${ARGN})
endfunction()

# A layer: an object library, with its internal headers in include/ of its folder. What it may include of them is what it links, so an
# upward or sideways include does not compile; of the public headers in libhive/include, tests/layers.sh refuses it. Sources that touch
# the machine and whose work the simulator does in its own way are NOT_SIMULATED: they are an object library NAME_unsimulated. HEADERS
# are precompiled, or HEADERS_OF another layer taken over.
function(hive_layer name)
  cmake_parse_arguments(PARSE_ARGV 1 layer "" "HEADERS_OF" "SOURCES;NOT_SIMULATED;DEPENDS;HEADERS")
  if(layer_SOURCES)
    set(scope PUBLIC)
    hive_part_of_layer(${name} "${layer_HEADERS_OF}" ${layer_SOURCES})
    target_precompile_headers(${name} PRIVATE ${layer_HEADERS})
    if(layer_HEADERS)
      set(layer_HEADERS_OF ${name})
    endif()
  else()
    set(scope INTERFACE)
    add_library(${name} INTERFACE)
  endif()
  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/include)
    target_include_directories(${name} ${scope} $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>)
  endif()
  target_link_libraries(${name} ${scope} ${layer_DEPENDS})
  if(layer_NOT_SIMULATED)
    hive_part_of_layer(${name}_unsimulated "${layer_HEADERS_OF}" ${layer_NOT_SIMULATED})
    target_link_libraries(${name}_unsimulated PUBLIC ${name})
  endif()
endfunction()

function(hive_part_of_layer name headers_of)
  add_library(${name} OBJECT ${ARGN})
  # A header of the standard library first, everywhere: from what it has seen so far asio chooses how it allocates, and all files must
  # choose alike.
  target_compile_options(${name} PRIVATE "SHELL:-include cstddef")
  hive_batches(${name} 16)
  if(headers_of)
    target_precompile_headers(${name} REUSE_FROM ${headers_of})
  endif()
  set_property(GLOBAL APPEND PROPERTY HIVE_LAYERS ${name})
endfunction()

# What a user runs: hivectl and every drone; the tests are not among it.
add_custom_target(programs)

# Installs a program and its man page as part of the package `component`; it finds the library beside its folder wherever it is installed.
function(hive_program target component)
  install(TARGETS ${target} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${component})
  install(FILES ${CMAKE_BINARY_DIR}/share/man/man1/${target}.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component})
  set_property(GLOBAL APPEND PROPERTY HIVE_PROGRAMS ${target})
  set_target_properties(${target} PROPERTIES INSTALL_RPATH "\$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
endfunction()

# Breaks the build, not the configuration, where something is absent: `target` needs it and fails with `sentence`.
function(hive_unbuildable target sentence)
  add_custom_target(${target}_unbuildable ALL COMMAND ${CMAKE_COMMAND} -E echo "${sentence}" COMMAND ${CMAKE_COMMAND} -E false VERBATIM)
  if(TARGET ${target})
    add_dependencies(${target} ${target}_unbuildable)
  endif()
endfunction()

# Those of the libraries ARGN that are on this machine, in `found`; the others, in `absent`. A library is a target or a file.
function(hive_find_absent found absent)
  set(here "")
  set(missing "")
  foreach(library ${ARGN})
    if(TARGET ${library} OR IS_ABSOLUTE "${library}")
      list(APPEND here ${library})
    else()
      string(REGEX REPLACE "^hive_|-NOTFOUND$" "" library "${library}")
      list(APPEND missing ${library})
    endif()
  endforeach()
  set(${found} "${here}" PARENT_SCOPE)
  set(${absent} "${missing}" PARENT_SCOPE)
endfunction()

# A drone: its algorithm as a library without Hive (so that it can be tested alone) and an executable hive-NAME, made of
# main.cpp and, where the wiring is longer than one file, WIRING. LIBRARIES are the algorithm's, or without one the executable's.
# It is a Debian package of its own, so that a machine installs the libraries of the drones that it runs. If this machine lacks one of
# the libraries, building the drone fails; the others can be built.
function(hive_drone name)
  cmake_parse_arguments(PARSE_ARGV 1 drone "" "" "ALGORITHM;LIBRARIES;WIRING")
  hive_find_absent(drone_LIBRARIES absent ${drone_LIBRARIES})
  if(drone_ALGORITHM)
    add_library(${name}_algorithm STATIC ${drone_ALGORITHM})
    target_include_directories(${name}_algorithm PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
    target_link_libraries(${name}_algorithm PUBLIC ${drone_LIBRARIES})
    hive_batches(${name}_algorithm 8)
  endif()
  add_executable(hive-${name} main.cpp ${drone_WIRING})
  target_link_libraries(hive-${name} PRIVATE hive hive_vision)
  target_precompile_headers(hive-${name} REUSE_FROM wiring_headers)
  if(drone_ALGORITHM)
    target_link_libraries(hive-${name} PRIVATE ${name}_algorithm)
  else()
    target_link_libraries(hive-${name} PRIVATE ${drone_LIBRARIES})
  endif()
  if(absent)
    list(JOIN absent ", " absent)
    hive_unbuildable(hive-${name} "hive-${name} needs libraries that are not installed: ${absent}; install them: scripts/install-deps users")
    if(drone_ALGORITHM)
      add_dependencies(${name}_algorithm hive-${name}_unbuildable)
    endif()
  endif()
  set_property(GLOBAL APPEND PROPERTY HIVE_DRONES ${name})
  add_dependencies(programs hive-${name})
  hive_program(hive-${name} hive-${name})
endfunction()

# A drone in Python: NAME.py (hyphens written as underscores) in its folder. What a build has in bin/ runs it from there, with the package
# of this build; a build with sanitizers has none, since the interpreter is built without them.
function(hive_python_drone name)
  string(REPLACE - _ file ${name})
  set(script ${CMAKE_CURRENT_SOURCE_DIR}/${file}.py)
  install(PROGRAMS ${script} DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME hive-${name} COMPONENT python3-hive)
  if(HIVE_SANITIZE OR "${HIVE_PYTHON}" STREQUAL "OFF")
    return()
  endif()
  if(NOT HIVE_PYTHON)
    hive_unbuildable(hive-${name} "hive-${name} needs Python 3.9 with NumPy and OpenCV; install them: scripts/install-deps users")
    add_dependencies(programs hive-${name}_unbuildable)
    return()
  endif()
  file(GENERATE OUTPUT ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/hive-${name}
    CONTENT "#!/bin/sh\nPYTHONPATH=${CMAKE_BINARY_DIR}/python\${PYTHONPATH:+:$PYTHONPATH} exec ${HIVE_PYTHON} ${script} \"$@\"\n"
    FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  set_property(GLOBAL APPEND PROPERTY HIVE_PYTHON_DRONES ${name})
  set_property(GLOBAL APPEND PROPERTY HIVE_PYTHON_FOLDERS ${CMAKE_CURRENT_SOURCE_DIR})
  add_dependencies(programs hive_c)
endfunction()
