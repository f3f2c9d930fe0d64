// Checks the file of a trusted certificate when the parameter is set, so that the error can name the file.
#pragma once

#include <string>

namespace capture {

/// @param path  a file with a certificate in PEM within its first MiB; empty: none, which is valid
/// @throws std::runtime_error  naming the file and what is wrong with it
void check_certificate(const std::string& path);

}  // namespace capture
