# The drones of a source tree, and nothing else of it, built against a libhive that is there already.
cmake_minimum_required(VERSION 3.25)
project(hive VERSION 0.1.0 LANGUAGES CXX)
list(APPEND CMAKE_MODULE_PATH ${HIVE_COPY}/scripts/cmake)
include(HiveBuild)
include(HiveOpenCV)
include(${HIVE_LIBRARIES})
add_subdirectory(${HIVE_COPY}/drones drones)
