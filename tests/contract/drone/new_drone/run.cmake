# Makes a drone with scripts/new-drone in a copy of the tree, builds it, and has it pass the drone contract suite; then the refusals.
# Its name is one of C's functions, too: a user cannot know them all.
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)

file(COPY ${SOURCE}/scripts ${SOURCE}/drones DESTINATION ${copy})
must(${copy}/scripts/new-drone gmtime-r)

file(SHA256 ${copy}/drones/CMakeLists.txt before)
foreach(name gmtime-r camera Main main class ../x a..b -x "a b" "" std x_y errno)
  must_refuse(${name})
endforeach()
file(SHA256 ${copy}/drones/CMakeLists.txt after)
file(GLOB left ${copy}/drones/.new-*)
if(left OR NOT before STREQUAL after)
  end("a refused new-drone has left something: ${left}")
endif()

file(COPY_FILE ${SOURCE}/tests/contract/drone/new_drone/project.cmake ${copy}/CMakeLists.txt)
must(${CMAKE_COMMAND} -S ${copy} -B ${copy}/build -G ${GENERATOR} -D HIVE_COPY=${copy} -D HIVE_LIBRARIES=${LIBHIVE}
  -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -D CMAKE_BUILD_TYPE=${TYPE} -D HIVE_SANITIZE=${SANITIZE}
  "-DCMAKE_CXX_FLAGS_DEBUG=${FLAGS}" -D CMAKE_CXX_FLAGS=-Werror)
must(${CMAKE_COMMAND} --build ${copy}/build --target hive-gmtime-r)
must_pass(${copy}/build/bin/hive-gmtime-r ${copy}/drones/gmtime-r)
file(REMOVE_RECURSE ${copy})
