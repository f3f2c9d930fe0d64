// The keys of a module, reloaded when its key file changes.
#pragma once

#include <hive/transport/key.hpp>

#include <sys/stat.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace hive::transport {

/// Reads the file on first use, and again after each change. If the file becomes unreadable, the known keys remain
/// valid, and trouble() has the error. On the network side.
class KeyRing {
public:
    /// @param required  a missing file is an error; otherwise it means no key, and this end dials without TLS
    explicit KeyRing(std::filesystem::path file, bool required = false) : file_(std::move(file)), required_(required) {}

    /// The keys that this end offers when it dials, newest first. Throws what read_key_file throws while no key is
    /// known, and Errc::not_permitted when no key of the file is valid any more.
    const std::vector<SwarmKey>& own();
    /// The keys that a peer may offer: own(), and the viewers' keys derived from them.
    const std::vector<SwarmKey>& accepted();
    /// Is that key in accepted() now?
    bool accepts(const std::string& id, Role role);
    /// Is it in own() now?
    bool offers(const std::string& id, Role role);
    [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }
    [[nodiscard]] bool required() const noexcept { return required_; }
    /// Why the file could not be reloaded; empty: no error.
    [[nodiscard]] const std::string& trouble() const noexcept { return trouble_; }

private:
    void refresh();
    void read();
    void drop_ended();

    std::filesystem::path file_;
    bool required_;
    struct stat seen_ {};  ///< the file's status when it was last read
    std::vector<SwarmKey> own_, accepted_;
    std::string trouble_;
};

}  // namespace hive::transport
