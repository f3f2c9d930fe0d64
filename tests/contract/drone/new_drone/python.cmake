# Makes a drone in Python with scripts/new-drone in a copy of the tree, and has it pass what the drone contract suite says of its own
# words: its page, its inputs, its parameters, its end. (The rest is the library's, and tried with the drone edges.) Then the refusals.
string(RANDOM LENGTH 8 word)
set(copy $ENV{TMPDIR})
if(NOT copy)
  set(copy /tmp)
endif()
set(copy ${copy}/hive-new-drone-${word})
file(MAKE_DIRECTORY ${copy}/drones)

function(end text)
  file(REMOVE_RECURSE ${copy})
  message(FATAL_ERROR "${text}")
endfunction()

function(must)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output TIMEOUT 280)
  if(code)
    end("${ARGN}: ${code}\n${output}")
  endif()
endfunction()

file(COPY ${SOURCE}/scripts DESTINATION ${copy})
file(COPY ${SOURCE}/drones/CMakeLists.txt DESTINATION ${copy}/drones)
must(${copy}/scripts/new-drone --python soft-glass)
file(READ ${copy}/drones/CMakeLists.txt drones)
if(NOT drones MATCHES "add_subdirectory\\(soft-glass\\)\n$")
  end("new-drone has not added the drone to the list")
endif()

foreach(name soft-glass json hive Main ../x --python "")
  execute_process(COMMAND ${copy}/scripts/new-drone --python ${name} RESULT_VARIABLE code ERROR_VARIABLE output OUTPUT_QUIET)
  if(NOT code EQUAL 2 OR NOT output MATCHES "^new-drone: ")
    end("new-drone --python ${name} was not refused: ${code} ${output}")
  endif()
endforeach()

file(WRITE ${copy}/hive-soft-glass
  "#!/bin/sh\nPYTHONPATH=${PACKAGE} exec ${PYTHON} ${copy}/drones/soft-glass/soft_glass.py \"$@\"\n")
file(CHMOD ${copy}/hive-soft-glass PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
set(ENV{HIVE_CONTRACT_PROGRAM} ${copy}/hive-soft-glass)
set(ENV{HIVE_CONTRACT_FOLDER} ${copy}/drones/soft-glass)
must(${SUITE} "--test-case=*--describe prints*,*the page lists*,*--help*,*the default of each*,*out of range*,*garbage put*,*SIGTERM*,*stop is answered*")
file(REMOVE_RECURSE ${copy})
