// Reads in blocks, so that a file that is too large is refused before it is in memory.
#include "words/file_text.hpp"

#include "words/output.hpp"

#include <hive/error.hpp>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <vector>

namespace hivectl {
namespace {

std::string text_of_stream(std::istream& in, const std::string& file, std::size_t most)
{
    std::string text;
    std::vector<char> block(1 << 20);
    while (in.read(block.data(), static_cast<std::streamsize>(block.size())), in.gcount() > 0) {
        text.append(block.data(), static_cast<std::size_t>(in.gcount()));
        hive::require_at_most(printable(file), text.size(), most);
    }
    if (in.bad())
        throw hive::Error(hive::Errc::io, "cannot read " + printable(file) + ": " + std::strerror(errno));
    return text;
}

}  // namespace

std::string text_of_file(const std::string& file, std::size_t most)
{
    if (file == "-")
        return text_of_stream(std::cin, "stdin", most);
    if (std::filesystem::is_directory(file))
        throw hive::Error(hive::Errc::io, "cannot read " + printable(file) + ": it is a directory");
    std::ifstream in(file, std::ios::binary);
    if (!in)
        throw hive::Error(hive::Errc::io, "cannot read " + printable(file) + ": " + std::strerror(errno));
    return text_of_stream(in, file, most);
}

}  // namespace hivectl
