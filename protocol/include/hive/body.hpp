// The binary part of an event: immutable bytes with one shared owner, and the buffer in which they are written.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace hive {

/// Immutable bytes; copying a Body copies none of them. The owner of the memory (a vector, an image, a receive buffer)
/// lives until the last Body over it is gone. Safe to share between threads.
class Body {
public:
    Body() = default;
    Body(std::vector<unsigned char> bytes);  // NOLINT: a vector is a body
    Body(std::string bytes);                 // NOLINT: a string is a body
    /// A view of memory that `owner` keeps alive and unchanged.
    Body(std::span<const std::byte> bytes, std::shared_ptr<const void> owner) : owner_(std::move(owner)), bytes_(bytes)
    {
    }
    ~Body() = default;
    Body(const Body&) = default;
    Body& operator=(const Body&) = default;
    /// A moved-from Body is empty: it must not show bytes that it no longer keeps alive.
    Body(Body&& other) noexcept
        : owner_(std::move(other.owner_)),
          bytes_(std::exchange(other.bytes_, {})),
          foreign_(std::exchange(other.foreign_, false))
    {
    }
    Body& operator=(Body&& other) noexcept
    {
        owner_ = std::move(other.owner_);
        bytes_ = std::exchange(other.bytes_, {});
        foreign_ = std::exchange(other.foreign_, false);
        return *this;
    }

    [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return bytes_; }
    [[nodiscard]] const unsigned char* data() const noexcept
    {
        return reinterpret_cast<const unsigned char*>(bytes_.data());
    }
    [[nodiscard]] std::size_t size() const noexcept { return bytes_.size(); }
    [[nodiscard]] bool empty() const noexcept { return bytes_.empty(); }
    /// True if the bytes lie in memory of the process that made them, which a broken or hostile process could still
    /// change: code that checks bytes before it uses them (a decoder) copies them first.
    [[nodiscard]] bool foreign() const noexcept { return foreign_; }
    /// A view of memory of another process.
    static Body in_foreign_memory(std::span<const std::byte> bytes, std::shared_ptr<const void> owner)
    {
        Body body(bytes, std::move(owner));
        body.foreign_ = true;
        return body;
    }

private:
    std::shared_ptr<const void> owner_;
    std::span<const std::byte> bytes_;
    bool foreign_ = false;
};

/// A buffer to be filled in place and then emitted as a Body. Output::loan() returns one in memory that receivers on
/// the same machine map, so that its bytes are never copied. For one thread at a time.
class Loan {
public:
    /// @param owner  keeps the memory as long as the loan, and then its body, lives
    Loan(std::span<std::byte> bytes, std::shared_ptr<void> owner) : owner_(std::move(owner)), bytes_(bytes) {}

    [[nodiscard]] unsigned char* data() const noexcept { return reinterpret_cast<unsigned char*>(bytes_.data()); }
    [[nodiscard]] std::size_t size() const noexcept { return bytes_.size(); }
    /// The filled buffer, which must not change any more.
    operator Body() && { return {bytes_, std::move(owner_)}; }  // NOLINT: a filled loan is a body
    /// Only the first `size` bytes of the buffer.
    Body body(std::size_t size) && { return {bytes_.first(size), std::move(owner_)}; }

private:
    std::shared_ptr<void> owner_;
    std::span<std::byte> bytes_;
};

}  // namespace hive
