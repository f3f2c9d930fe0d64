// The files of the page, embedded in the program; their sources are in page/.
#pragma once

#include <string_view>

namespace hivectl::dash {

struct File {
    std::string_view path, type, text;
};

/// The file at that path of the address, or nullptr.
const File* file_at(std::string_view path);

}  // namespace hivectl::dash
