# What the tests of scripts/new-drone share: a copy of the tree that goes away however the test ends.
string(RANDOM LENGTH 8 word)
set(copy $ENV{TMPDIR})
if(NOT copy)
  set(copy /tmp)
endif()
set(copy ${copy}/hive-new-drone-${word})
file(MAKE_DIRECTORY ${copy})

# Fails the test.
function(end text)
  file(REMOVE_RECURSE ${copy})
  message(FATAL_ERROR "${text}")
endfunction()

# Runs a command that must succeed.
function(must)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output TIMEOUT 280)
  if(code)
    end("${ARGN}: ${code}\n${output}")
  endif()
endfunction()

# new-drone with these words must say what is wrong, and make nothing.
function(must_refuse)
  execute_process(COMMAND ${copy}/scripts/new-drone ${ARGN} RESULT_VARIABLE code ERROR_VARIABLE output OUTPUT_QUIET)
  if(NOT code EQUAL 2 OR NOT output MATCHES "^new-drone: ")
    end("new-drone ${ARGN} was not refused: ${code} ${output}")
  endif()
endfunction()

# The drone contract suite, of a program and its folder.
function(must_pass program folder)
  set(ENV{HIVE_CONTRACT_PROGRAM} ${program})
  set(ENV{HIVE_CONTRACT_FOLDER} ${folder})
  must(${SUITE} ${ARGN})
endfunction()
