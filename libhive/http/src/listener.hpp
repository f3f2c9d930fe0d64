// A TCP socket that listens.
#pragma once

#include <hive/http/host.hpp>

#include <string>
#include <utility>

namespace hive::http {

/// Closes it.
class Descriptor {
public:
    explicit Descriptor(int number) : number_(number) {}
    ~Descriptor();
    Descriptor(Descriptor&& other) noexcept : number_(other.release()) {}
    Descriptor& operator=(Descriptor&&) = delete;
    [[nodiscard]] int get() const noexcept { return number_; }
    int release() noexcept { return std::exchange(number_, -1); }

private:
    int number_;
};

/// Listens without blocking. Throws std::runtime_error: "cannot listen at …: Address already in use".
Descriptor listen_at(const Address& address, const std::string& url);
int port_of(const Descriptor& socket);

}  // namespace hive::http
