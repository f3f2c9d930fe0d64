// The file of the certificate to trust: looked at when it is named, because later nobody would know which file was
// meant.
#pragma once

#include <string>

namespace axis {

/// @param path  a file with a certificate in PEM within its first MiB; empty: none is named, which is right
/// @throws std::runtime_error  naming the file and what is wrong with it
void check_certificate(const std::string& path);

}  // namespace axis
