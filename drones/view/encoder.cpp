// Encodes the requested kinds, both from the same image, without the lock.
#include "encoder.hpp"

#include <hive/platform/crash_signals.hpp>

#include <exception>
#include <utility>

namespace view {

Encoder::Encoder(const Exchange& exchange, std::function<void()> done) : exchange_(exchange), done_(std::move(done))
{
    const hive::platform::SignalsBlocked blocked;
    thread_ = std::thread([this] { run(); });
}

Encoder::~Encoder()
{
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    changed_.notify_one();
    thread_.join();
}

Encoded Encoder::newest(bool plain, Exchange::Time now)
{
    const auto version = exchange_.newest(now).version;
    const std::lock_guard lock(mutex_);
    Kind& kind = plain ? plain_ : captioned_;
    if (!kind.ready.jpeg || kind.ready.version != version) {
        kind.asked = true;
        changed_.notify_one();
    }
    return kind.ready;
}

void Encoder::run()
{
    for (std::unique_lock lock(mutex_);;) {
        changed_.wait(lock, [this] { return ending_ || captioned_.asked || plain_.asked; });
        if (ending_)
            return;
        const bool captioned = std::exchange(captioned_.asked, false), plain = std::exchange(plain_.asked, false);
        lock.unlock();
        try {
            const auto newest = exchange_.newest();  // kept no longer than it is worked on
            if (captioned)
                encode(captioned_, *newest.image, newest.version);
            if (plain)
                encode(plain_, *newest.image, newest.version);
        } catch (const std::exception&) {  // out of memory: a browser that still waits requests it again
        }
        lock.lock();
    }
}

void Encoder::encode(Kind& kind, const Image& image, std::uint64_t version)
{
    Encoded encoded{&kind == &plain_ ? image.plain_jpeg() : image.jpeg(), version};
    {
        const std::lock_guard lock(mutex_);
        std::swap(kind.ready, encoded);
    }
    done_();
}

}  // namespace view
