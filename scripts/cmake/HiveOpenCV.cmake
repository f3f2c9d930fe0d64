# Finds the OpenCV modules one by one, as targets hive_opencv::core and so on: a distribution may package each alone,
# and OpenCV's own CMake package demands all of them. Modules that only some drones need may be absent.
include_guard(GLOBAL)

find_path(HIVE_OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)

function(hive_opencv_module name)
  find_library(HIVE_OPENCV_${name} opencv_${name} ${ARGN})
  if(NOT HIVE_OPENCV_${name})
    return()
  endif()
  add_library(hive_opencv::${name} UNKNOWN IMPORTED GLOBAL)
  set_target_properties(hive_opencv::${name} PROPERTIES
    IMPORTED_LOCATION ${HIVE_OPENCV_${name}} INTERFACE_INCLUDE_DIRECTORIES ${HIVE_OPENCV_INCLUDE_DIR})
endfunction()

foreach(module core imgproc imgcodecs)
  hive_opencv_module(${module} REQUIRED)
endforeach()
foreach(module video videoio objdetect dnn highgui)
  hive_opencv_module(${module})
endforeach()
