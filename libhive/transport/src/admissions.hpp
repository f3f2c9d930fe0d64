// Limits the number of a listener's peers that have not sent a hello.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace hive::transport {

/// Counts tokens; on the network side.
class Admissions : public std::enable_shared_from_this<Admissions> {
public:
    static constexpr std::size_t most = 64;

    [[nodiscard]] bool full() const { return free() == 0; }
    [[nodiscard]] std::size_t free() const { return most - count_; }
    /// Admits one more peer; its slot is free again when the last copy of the token is destroyed.
    std::shared_ptr<void> admit();
    /// Called whenever a slot becomes free.
    std::function<void()> freed;

private:
    std::size_t count_ = 0;
};

}  // namespace hive::transport
