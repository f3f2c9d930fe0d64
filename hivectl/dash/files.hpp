// The files of the page, which are part of the program: page/ has them as people read them.
#pragma once

#include <string_view>

namespace hivectl::dash {

struct File {
    std::string_view path, type, text;
};

/// The file at that path of the address, or nullptr.
const File* file_at(std::string_view path);

}  // namespace hivectl::dash
