# shellcheck shell=bash
# Programs on pages as files: those of libhive/language/README.md and README's drone, each in a folder of its own; to be
# sourced.

block() { # PAGE LANGUAGE MARK: the block of that language on the page that has the mark
    awk -v fence="\`\`\`$2" -v mark="$3" '
        $0 == fence { inside = 1; text = ""; next }
        inside && /^```/ { if (index(text, mark)) printf "%s", text; inside = 0 }
        inside { text = text $0 "\n" }' "$1"
}

vision_line() { # PAGE: its find_package() for drones that handle images, which may span two lines
    tr '\n' ' ' < "$1" | grep -Eo 'find_package\(hive [^)]*COMPONENTS +vision\)' | head -n 1
}

project() { # NAME FIND TARGET: the CMakeLists.txt of a drone outside of the repository; Hive sets the language level
    cat << END
cmake_minimum_required(VERSION 3.25)
project($1 LANGUAGES CXX)
$2
add_executable(hive-$1 main.cpp)
target_link_libraries(hive-$1 $3)
END
}

write_drones() { # SOURCE PLACE: PLACE/cpp and PLACE/blur with their CMakeLists.txt, PLACE/c, PLACE/py
    local page=$1/libhive/language/README.md place=$2
    mkdir -p "$place/cpp" "$place/blur" "$place/c" "$place/py"
    block "$1/README.md" cpp run_drone > "$place/blur/main.cpp"
    project blur "$(vision_line "$1/README.md")" hive::vision > "$place/blur/CMakeLists.txt"
    block "$page" cpp run_drone > "$place/cpp/main.cpp"
    block "$page" c hive_drone_from_arguments > "$place/c/main.c"
    block "$page" python 'Drone("brightness"' > "$place/py/brightness.py"
    project brightness "find_package(hive 0.1 REQUIRED)" hive::hive > "$place/cpp/CMakeLists.txt"
}
