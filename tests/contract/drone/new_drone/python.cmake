# Makes a drone in Python with scripts/new-drone in a copy of the tree, and has it pass what the drone contract suite says of its own
# words: its page, its inputs, its parameters, its end. (The rest is the library's, and tried with the drone edges.) Then the refusals.
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)

file(COPY ${SOURCE}/scripts DESTINATION ${copy})
file(COPY ${SOURCE}/drones/CMakeLists.txt DESTINATION ${copy}/drones)
must(${copy}/scripts/new-drone --python soft-glass)
file(READ ${copy}/drones/CMakeLists.txt drones)
if(NOT drones MATCHES "add_subdirectory\\(soft-glass\\)\n$")
  end("new-drone has not added the drone to the list")
endif()

foreach(name soft-glass json hive Main ../x --python "")
  must_refuse(--python ${name})
endforeach()

file(WRITE ${copy}/hive-soft-glass
  "#!/bin/sh\nPYTHONPATH=${PACKAGE} exec ${PYTHON} ${copy}/drones/soft-glass/soft_glass.py \"$@\"\n")
file(CHMOD ${copy}/hive-soft-glass PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
must_pass(${copy}/hive-soft-glass ${copy}/drones/soft-glass
  "--test-case=*--describe prints*,*the page lists*,*--help*,*the default of each*,*out of range*,*garbage put*,*SIGTERM*,*stop is answered*")
file(REMOVE_RECURSE ${copy})
