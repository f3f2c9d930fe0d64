# shellcheck shell=bash
# Programs on pages as files: those of libhive/language/README.md each in a folder of its own; to be sourced.

block() { # PAGE LANGUAGE MARK: the block of that language on the page that has the mark
    awk -v fence="\`\`\`$2" -v mark="$3" '
        $0 == fence { inside = 1; text = ""; next }
        inside && /^```/ { if (index(text, mark)) printf "%s", text; inside = 0 }
        inside { text = text $0 "\n" }' "$1"
}

write_drones() { # SOURCE PLACE: PLACE/cpp with its CMakeLists.txt, PLACE/c, PLACE/py
    local page=$1/libhive/language/README.md place=$2
    mkdir -p "$place/cpp" "$place/c" "$place/py"
    block "$page" cpp run_drone > "$place/cpp/main.cpp"
    block "$page" c hive_drone_from_arguments > "$place/c/main.c"
    block "$page" python hive.Drone > "$place/py/brightness.py"
    cat > "$place/cpp/CMakeLists.txt" << 'END'
cmake_minimum_required(VERSION 3.25)
project(brightness LANGUAGES CXX)
set(CMAKE_CXX_STANDARD 20)
find_package(hive 0.1 REQUIRED)
add_executable(hive-brightness main.cpp)
target_link_libraries(hive-brightness hive::hive)
END
}
