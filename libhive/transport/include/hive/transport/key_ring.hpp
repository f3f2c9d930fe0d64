// The keys that a module holds, as its file has them now.
#pragma once

#include <hive/key.hpp>

#include <sys/stat.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace hive::transport {

/// Reads the file when it is first asked, and again when the file has changed. A file that cannot be read any more
/// changes nothing: the keys that are known go on to hold, and trouble() says why. On the network side.
class KeyRing {
public:
    /// @param required  a file that is not there is an error; otherwise it is no key, and this end dials in the plain
    explicit KeyRing(std::filesystem::path file, bool required = false) : file_(std::move(file)), required_(required) {}

    /// What this end shows when it dials, newest first. Throws what read_key_file throws, when nothing is known yet,
    /// and Errc::not_permitted when no key of the file holds any longer.
    const std::vector<SwarmKey>& own();
    /// What a peer may show: the same, and the viewers' keys that are made of them.
    const std::vector<SwarmKey>& accepted();
    /// Is that one of accepted() now?
    bool accepts(const std::string& id, Role role);
    [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }
    [[nodiscard]] bool required() const noexcept { return required_; }
    /// Why the file could not be read again; empty when all is well.
    [[nodiscard]] const std::string& trouble() const noexcept { return trouble_; }

private:
    void refresh();
    void read();
    void drop_ended();

    std::filesystem::path file_;
    bool required_;
    struct stat seen_ {};  ///< of the file when it was last read
    std::vector<SwarmKey> own_, accepted_;
    std::string trouble_;
};

}  // namespace hive::transport
