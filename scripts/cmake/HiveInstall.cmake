# What `cmake --install` puts where, in the components that CPack makes Debian packages of: libhive0, libhive-dev, hivectl,
# hive-KIND for each drone, python3-hive, and hive, which brings hivectl and every drone but view (that one brings Qt).
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/hive)

# The libraries.
install(TARGETS hive hive_c EXPORT hive
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libhive0 NAMELINK_COMPONENT libhive-dev)
install(TARGETS hive_vision EXPORT hive-vision ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libhive-dev)
set_target_properties(hive_c PROPERTIES EXPORT_NAME c INSTALL_RPATH "\$ORIGIN")
set_target_properties(hive_vision PROPERTIES EXPORT_NAME vision)
target_link_libraries(hive_vision INTERFACE $<INSTALL_INTERFACE:hive::hive>)
foreach(target hive hive_vision)
  target_compile_features(${target} INTERFACE cxx_std_20)
endforeach()
foreach(target hive hive_c hive_vision)
  target_include_directories(${target} PUBLIC $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
endforeach()

# The public headers. Those in hive/protocol are internal to libhive.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/libhive/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT libhive-dev)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/protocol/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT libhive-dev
  PATTERN hive/protocol EXCLUDE)

# find_package(hive), and pkg-config.
install(EXPORT hive NAMESPACE hive:: FILE hive-targets.cmake DESTINATION ${package} COMPONENT libhive-dev)
install(EXPORT hive-vision NAMESPACE hive:: FILE hive-vision-targets.cmake DESTINATION ${package} COMPONENT libhive-dev)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/hive-config.cmake.in ${CMAKE_BINARY_DIR}/package/hive-config.cmake
  INSTALL_DESTINATION ${package})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/hive-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/package/hive-config.cmake ${CMAKE_BINARY_DIR}/package/hive-config-version.cmake
  ${CMAKE_CURRENT_LIST_DIR}/HiveOpenCV.cmake DESTINATION ${package} COMPONENT libhive-dev)
file(RELATIVE_PATH pc_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
foreach(module hive hive-c)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/${module}.pc.in ${CMAKE_BINARY_DIR}/package/${module}.pc @ONLY)
  install(FILES ${CMAKE_BINARY_DIR}/package/${module}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT libhive-dev)
endforeach()

# The Python package, where Debian's Python looks when the prefix is /usr.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/libhive/language/python/hive DESTINATION lib/python3/dist-packages COMPONENT python3-hive
  FILES_MATCHING PATTERN "*.py" PATTERN "py.typed" PATTERN "__pycache__" EXCLUDE)

# Completions, man pages and Debian's changelog, from what the programs and changelog.md say.
get_property(drones GLOBAL PROPERTY HIVE_DRONES)
list(TRANSFORM drones PREPEND hive-)
get_property(programs GLOBAL PROPERTY HIVE_PROGRAMS)
set(changelog ${PROJECT_SOURCE_DIR}/libhive/docs/changelog.md)
set(HIVE_MAINTAINER "The Hive maintainers <hive@example.org>" CACHE STRING "maintainer of the Debian packages, with an address")
add_custom_command(OUTPUT ${CMAKE_BINARY_DIR}/share/made
  COMMAND ${PROJECT_SOURCE_DIR}/scripts/make-documents ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_BINARY_DIR}/share ${PROJECT_VERSION}
    ${changelog} ${HIVE_MAINTAINER} ${programs}
  COMMAND ${CMAKE_COMMAND} -E touch ${CMAKE_BINARY_DIR}/share/made
  DEPENDS ${programs} ${changelog} ${PROJECT_SOURCE_DIR}/scripts/make-documents ${PROJECT_SOURCE_DIR}/scripts/make-man VERBATIM)
add_custom_target(documents ALL DEPENDS ${CMAKE_BINARY_DIR}/share/made)
install(DIRECTORY ${CMAKE_BINARY_DIR}/share/man ${CMAKE_BINARY_DIR}/share/bash-completion ${CMAKE_BINARY_DIR}/share/zsh
  ${CMAKE_BINARY_DIR}/share/fish DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT hivectl PATTERN "hive-*.1.gz" EXCLUDE)

# What watches a swarm with Prometheus.
install(FILES ${PROJECT_SOURCE_DIR}/hivectl/monitoring/hive.rules.yml ${PROJECT_SOURCE_DIR}/hivectl/monitoring/grafana.json
  DESTINATION ${CMAKE_INSTALL_DATADIR}/hive COMPONENT hivectl)
install(FILES ${PROJECT_SOURCE_DIR}/hivectl/monitoring/hive-metrics.service DESTINATION lib/systemd/user COMPONENT hivectl)

# The Debian packages.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME hive)
set(CPACK_PACKAGE_CONTACT ${HIVE_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "distributed vision processing")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_OUTPUT_FILE_PREFIX ${CMAKE_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL libhive0 libhive-dev hivectl ${drones} hive python3-hive)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(exactly "(= ${PROJECT_VERSION})")
foreach(component ${CPACK_COMPONENTS_ALL})
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${component})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION video)
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "libhive0 ${exactly}")
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "the drone ${component}; hivectl starts it and connects it with others")
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${component} RENAME copyright
    COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES ${CMAKE_BINARY_DIR}/share/doc/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${component}
    COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
set(CPACK_COMPONENT_LIBHIVE0_DESCRIPTION "the libraries")
set(CPACK_COMPONENT_LIBHIVE-DEV_DESCRIPTION "to build drones and applications in C++ and C")
set(CPACK_COMPONENT_HIVECTL_DESCRIPTION "hivectl, which starts and connects drones")
set(CPACK_COMPONENT_HIVE_DESCRIPTION "metapackage: hivectl and every drone that needs no window")
set(CPACK_COMPONENT_PYTHON3-HIVE_DESCRIPTION "drones and applications in Python")
set(CPACK_DEBIAN_LIBHIVE0_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBHIVE0_PACKAGE_DEPENDS "elfutils")  # eu-addr2line names the functions in the trace of a crash
set(CPACK_DEBIAN_LIBHIVE0_PACKAGE_RECOMMENDS "libavahi-client3")  # loaded, not linked
set(CPACK_DEBIAN_LIBHIVE0_PACKAGE_SUGGESTS "avahi-daemon")
file(WRITE ${CMAKE_BINARY_DIR}/package/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBHIVE0_PACKAGE_CONTROL_EXTRA ${CMAKE_BINARY_DIR}/package/triggers)
set(CPACK_DEBIAN_LIBHIVE-DEV_PACKAGE_SECTION libdevel)
string(APPEND CPACK_DEBIAN_LIBHIVE-DEV_PACKAGE_DEPENDS
  ", nlohmann-json3-dev, libopencv-core-dev, libopencv-imgproc-dev, libpng-dev, libturbojpeg0-dev")
set(CPACK_DEBIAN_HIVECTL_PACKAGE_SUGGESTS "hive, graphviz")
string(APPEND CPACK_DEBIAN_HIVE-FACE_PACKAGE_DEPENDS ", opencv-data")
string(APPEND CPACK_DEBIAN_HIVE-GESTURE_PACKAGE_DEPENDS ", opencv-data")
foreach(package hivectl ${drones})
  if(NOT package STREQUAL hive-view)
    string(APPEND CPACK_DEBIAN_HIVE_PACKAGE_DEPENDS ", ${package} ${exactly}")
  endif()
endforeach()
set(CPACK_DEBIAN_HIVE_PACKAGE_SUGGESTS "hive-view, python3-hive")
set(CPACK_DEBIAN_PYTHON3-HIVE_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON3-HIVE_PACKAGE_SECTION python)
string(APPEND CPACK_DEBIAN_PYTHON3-HIVE_PACKAGE_DEPENDS ", python3 (>= 3.9)")
set(CPACK_DEBIAN_PYTHON3-HIVE_PACKAGE_RECOMMENDS "python3-numpy, python3-opencv, libturbojpeg0")
include(CPack)
