// What any TLS has to do with a frame: AES-128-GCM, 16 KiB at a time, each with a tag of 16 bytes.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

namespace hive::bench {

/// One direction, with a key that everybody knows. The cipher is the one of Hive's sessions, but
/// from the frame into what is sent, and out of what came into the frame, without any other copy.
class Seal {
public:
    static constexpr std::size_t record = 16 * 1024, tag = 16;
    /// Of a frame with its tags.
    static constexpr std::size_t sealed_size(std::size_t size) { return size + (size + record - 1) / record * tag; }

    explicit Seal(bool encrypts);
    ~Seal();

    /// Encrypts a frame; `to` has room for the tags as well.
    void close(std::span<const std::byte> frame, std::byte* to);
    /// Decrypts what close() made of a frame of this size; false when it was damaged.
    [[nodiscard]] bool open(std::span<const std::byte> sealed, std::span<std::byte> frame);

private:
    struct Cipher;
    std::unique_ptr<Cipher> cipher_;
};

}  // namespace hive::bench
