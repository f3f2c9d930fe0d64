// Searches for the line with which every PEM certificate starts.
#include "certificate_file.hpp"

#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace capture {

void check_certificate(const std::string& path)
{
    if (path.empty())
        return;
    std::error_code none;
    if (!std::filesystem::is_regular_file(path, none))
        throw std::runtime_error("certificate: no such file: " + path);
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw std::runtime_error("certificate: cannot read " + path);
    std::string text(1u << 20, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(file.gcount()));
    if (text.find("-----BEGIN CERTIFICATE-----") == std::string::npos
        && text.find("-----BEGIN TRUSTED CERTIFICATE-----") == std::string::npos)
        throw std::runtime_error("certificate: " + path
                                 + " contains no certificate (PEM starts with -----BEGIN CERTIFICATE-----)");
}

}  // namespace capture
