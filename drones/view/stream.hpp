// Writes the endless body of an MJPEG stream (multipart/x-mixed-replace). Each reader gets the newest image when it
// is ready for one.
#pragma once

#include "encoder.hpp"

#include <hive/http/answer.hpp>

#include <functional>
#include <span>
#include <utility>

namespace view {

/// The bytes for one reader. For one thread.
class Stream final : public hive::http::EndlessBody {
public:
    static constexpr const char* type = "multipart/x-mixed-replace; boundary=picture";

    using Newest = std::function<Encoded(Exchange::Time now)>;

    /// @param newest  the newest image that is ready; null while there is none
    /// @param repeat  after this long without a new image, or a new text on it, the last one is sent again, to
    ///                detect closed readers
    Stream(Newest newest, std::chrono::milliseconds repeat) : newest_(std::move(newest)), repeat_(repeat) {}
    std::size_t read(std::span<char> to, Exchange::Time now) override;

private:
    bool begin_part(Exchange::Time now);

    Newest newest_;
    std::chrono::milliseconds repeat_;
    // The data being sent: only the JPEG, so that a slow reader keeps no pixels in memory.
    std::string head_;
    Jpeg jpeg_;
    std::size_t sent_ = 0;  ///< of head, JPEG and end together
    std::uint64_t version_ = 0;
    Exchange::Time started_{};
};

}  // namespace view
