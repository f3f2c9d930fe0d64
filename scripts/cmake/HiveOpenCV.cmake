# Finds OpenCV modules as targets, hive_opencv::core and so on: a distribution may package each alone, and OpenCV's own
# CMake package demands all of them. Every target that uses a module names it first, so that no other need be installed.
include_guard(GLOBAL)

find_path(HIVE_OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)

# A module that is not REQUIRED may be absent: then it has no target.
function(hive_opencv_modules)
  cmake_parse_arguments(PARSE_ARGV 0 modules "REQUIRED" "" "")
  foreach(name ${modules_UNPARSED_ARGUMENTS})
    find_library(HIVE_OPENCV_${name} opencv_${name})
    if(modules_REQUIRED AND NOT HIVE_OPENCV_${name})
      message(FATAL_ERROR "OpenCV's module ${name} is not installed; on Debian: apt-get install libopencv-${name}-dev")
    endif()
    if(HIVE_OPENCV_${name} AND NOT TARGET hive_opencv::${name})
      add_library(hive_opencv::${name} UNKNOWN IMPORTED GLOBAL)
      set_target_properties(hive_opencv::${name} PROPERTIES
        IMPORTED_LOCATION ${HIVE_OPENCV_${name}} INTERFACE_INCLUDE_DIRECTORIES ${HIVE_OPENCV_INCLUDE_DIR})
    endif()
  endforeach()
endfunction()

hive_opencv_modules(core imgproc REQUIRED)  # hive_vision itself
