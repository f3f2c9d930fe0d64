// Streams through memory.
#include "memory_pipe.hpp"

#include <asio/error.hpp>
#include <asio/steady_timer.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <mutex>

namespace hive::transport {
namespace {

constexpr std::size_t capacity = 64 * 1024;

/// An operation that waits. It waits on a timer that never expires, so that it belongs to its io_context like one of a
/// socket: it is work, it is completed on that thread, and it goes when the context goes.
struct Waiter {
    asio::steady_timer* timer = nullptr;  ///< null when nothing waits
    std::error_code error;
    std::size_t bytes = 0;

    void finish(std::error_code result, std::size_t count)
    {
        error = result;
        bytes = count;
        std::exchange(timer, nullptr)->cancel();
    }
};

/// One direction.
struct Channel {
    std::unique_ptr<unsigned char[]> ring = std::make_unique_for_overwrite<unsigned char[]>(capacity);
    std::size_t begin = 0, size = 0;
    bool writer_gone = false, reader_gone = false;
    Waiter reader, writer;
    asio::mutable_buffer into;
    std::span<const asio::const_buffer> from;

    void flow()
    {
        take_in();
        give_out();
        take_in();  // into the room that reading made
    }
    void take_in()
    {
        if (!writer.timer)
            return;
        if (reader_gone)
            return writer.finish(asio::error::broken_pipe, 0);
        if (size == capacity)
            return;
        std::size_t taken = 0;
        for (const auto& buffer : from)
            taken += put(static_cast<const unsigned char*>(buffer.data()), buffer.size());
        writer.finish({}, taken);
    }
    void give_out()
    {
        if (!reader.timer)
            return;
        if (size > 0)
            reader.finish({}, get(static_cast<unsigned char*>(into.data()), into.size()));
        else if (writer_gone)
            reader.finish(asio::error::eof, 0);
    }
    std::size_t put(const unsigned char* bytes, std::size_t count)
    {
        count = std::min(count, capacity - size);
        const auto end = (begin + size) % capacity;
        const auto straight = std::min(count, capacity - end);
        std::copy_n(bytes, straight, &ring[end]);
        std::copy_n(bytes + straight, count - straight, &ring[0]);
        size += count;
        return count;
    }
    std::size_t get(unsigned char* bytes, std::size_t count)
    {
        count = std::min(count, size);
        const auto straight = std::min(count, capacity - begin);
        std::copy_n(&ring[begin], straight, bytes);
        std::copy_n(&ring[0], count - straight, bytes + straight);
        begin = (begin + count) % capacity;
        size -= count;
        return count;
    }
};

struct Pipe {
    std::mutex mutex;
    std::array<Channel, 2> channels;
};

class MemoryStream final : public Stream {
public:
    MemoryStream(asio::io_context& context, std::shared_ptr<Pipe> pipe, int end, std::string peer)
        : pipe_(std::move(pipe)),
          in_(pipe_->channels[1 - end]),
          out_(pipe_->channels[end]),
          peer_(std::move(peer)),
          read_timer_(context),
          write_timer_(context)
    {
    }
    MemoryStream(const MemoryStream&) = delete;
    MemoryStream& operator=(const MemoryStream&) = delete;
    ~MemoryStream() override { close(); }

    void read_some(asio::mutable_buffer into, Handler handler) override
    {
        const std::lock_guard lock(pipe_->mutex);
        in_.into = into;
        begin(in_.reader, read_timer_, std::move(handler));
        if (in_.reader_gone)
            return in_.reader.finish(asio::error::bad_descriptor, 0);
        in_.flow();
    }
    void write_some(std::span<const asio::const_buffer> from, Handler handler) override
    {
        const std::lock_guard lock(pipe_->mutex);
        out_.from = from;
        begin(out_.writer, write_timer_, std::move(handler));
        if (out_.writer_gone)
            return out_.writer.finish(asio::error::bad_descriptor, 0);
        out_.flow();
    }
    void close() noexcept override
    {
        const std::lock_guard lock(pipe_->mutex);
        in_.reader_gone = out_.writer_gone = true;
        for (auto* waiter : {&in_.reader, &out_.writer})
            if (waiter->timer)
                waiter->finish(asio::error::operation_aborted, 0);
        in_.flow();
        out_.flow();
    }
    [[nodiscard]] std::string peer() const override { return peer_; }
    [[nodiscard]] bool local() const override { return true; }
    [[nodiscard]] Credentials credentials() const override { return {.role = Role::owner, .key = {}}; }

private:
    void begin(Waiter& waiter, asio::steady_timer& timer, Handler handler)
    {
        waiter.timer = &timer;
        timer.expires_at(asio::steady_timer::time_point::max());
        timer.async_wait([pipe = pipe_, &waiter, handler = std::move(handler)](std::error_code) {
            std::unique_lock lock(pipe->mutex);
            const auto error = waiter.error;
            const auto bytes = waiter.bytes;
            lock.unlock();
            handler(error, bytes);
        });
    }

    std::shared_ptr<Pipe> pipe_;
    Channel& in_;
    Channel& out_;
    std::string peer_;
    asio::steady_timer read_timer_, write_timer_;
};

}  // namespace

std::pair<std::unique_ptr<Stream>, std::unique_ptr<Stream>>
make_memory_pipe(asio::io_context& first, asio::io_context& second, const std::string& peer)
{
    auto pipe = std::make_shared<Pipe>();
    return {std::make_unique<MemoryStream>(first, pipe, 0, peer),
            std::make_unique<MemoryStream>(second, pipe, 1, peer)};
}

}  // namespace hive::transport
