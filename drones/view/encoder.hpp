// Decodes and encodes images on its own thread, so that the server thread never waits for it.
#pragma once

#include "exchange.hpp"

#include <condition_variable>
#include <functional>
#include <thread>

namespace view {

/// An image as browsers get it.
struct Encoded {
    Jpeg jpeg;  ///< null: there was none yet
    std::uint64_t version = 0;
};

/// Encodes one image at a time, then the newest one; idle without requests.
class Encoder {
public:
    /// @param exchange  outlives the encoder
    /// @param done      called on its thread when an image is ready
    Encoder(const Exchange& exchange, std::function<void()> done);
    /// Waits for the current image.
    ~Encoder();
    Encoder(const Encoder&) = delete;
    Encoder& operator=(const Encoder&) = delete;

    /// The last encoded image; if it is not the newest one, starts encoding that. Never blocks. From any thread.
    /// @param plain  without the caption
    Encoded newest(bool plain, Exchange::Time now = std::chrono::steady_clock::now());

private:
    /// With the caption, or without.
    struct Kind {
        Encoded ready;
        bool asked = false;
    };

    void run();
    void encode(Kind& kind, const Image& image, std::uint64_t version);

    const Exchange& exchange_;
    std::function<void()> done_;
    std::mutex mutex_;
    std::condition_variable changed_;
    Kind captioned_, plain_;  ///< under the mutex
    bool ending_ = false;     ///< under the mutex
    std::thread thread_;
};

}  // namespace view
