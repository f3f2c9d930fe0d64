// The shared memory of raw_shm: one page of control words, then the slots.
#pragma once

#include "../harness/board.hpp"
#include "../harness/run.hpp"

namespace hive::bench {

constexpr std::uint32_t slots = 8, ring = 64;
constexpr std::size_t page = 4096;

struct Control {
    alignas(64) Word head{0};      ///< frames published, or requests answered
    alignas(64) Word sleepers{0};  ///< receivers that sleep on head
    alignas(64) Word freed{0};     ///< rung when a frame was read while the publisher waits
    Word publisher_waits{0};
    alignas(64) std::array<std::atomic<std::uint8_t>, ring> slot_of;  ///< the slot of a frame
    struct alignas(64) Reader {
        Word tail{0};  ///< frames read
    };
    std::array<Reader, most_subscribers> readers;
    alignas(64) Word requests{0}, server_sleeps{0};
    Request request;
    Word ready{0};
};
static_assert(sizeof(Control) <= page);

/// Sleeps until the word has this value.
inline void await(Word& word, std::uint32_t value, Word& sleepers)
{
    for (auto now = word.load(); now != value; now = word.load()) {
        ++sleepers;
        futex_wait(word, now);
        --sleepers;
    }
}

/// Made by the publisher or the server, then mapped by the others. Every page is there before it is used.
class Segment {
public:
    /// Throws std::runtime_error, also when nobody has made it within 5 s.
    Segment(std::size_t frame, Role role);

    [[nodiscard]] Control& control() const { return *reinterpret_cast<Control*>(base_); }
    [[nodiscard]] std::span<std::byte> slot(std::uint32_t index) const
    {
        return {base_ + page + index * stride_, frame_};
    }
    /// Puts a frame into a slot. @param in_place  the camera's image is there already
    void put(const Frame& frame, std::uint32_t index, bool in_place) const;

private:
    void fill() const;
    void touch_all(std::size_t size) const;

    std::size_t frame_, stride_;
    std::byte* base_ = nullptr;
};

}  // namespace hive::bench
