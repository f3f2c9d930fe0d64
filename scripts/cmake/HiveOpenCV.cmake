# Finds an OpenCV module as a target, hive_opencv::core and so on: a distribution may package each alone, and OpenCV's own
# CMake package demands all of them. Every target that uses a module names it first, so that no other need be installed.
include_guard(GLOBAL)

find_path(HIVE_OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)

function(hive_opencv_modules)
  foreach(name ${ARGN})
    if(TARGET hive_opencv::${name})
      continue()
    endif()
    find_library(HIVE_OPENCV_${name} opencv_${name} REQUIRED)
    add_library(hive_opencv::${name} UNKNOWN IMPORTED GLOBAL)
    set_target_properties(hive_opencv::${name} PROPERTIES
      IMPORTED_LOCATION ${HIVE_OPENCV_${name}} INTERFACE_INCLUDE_DIRECTORIES ${HIVE_OPENCV_INCLUDE_DIR})
  endforeach()
endfunction()

hive_opencv_modules(core imgproc)  # hive_vision itself
