// Bytes in flight, and the two streams.
#include "pipe.hpp"

#include <asio/error.hpp>

#include <algorithm>
#include <cstring>
#include <utility>

namespace hive::simulation {

using namespace std::chrono_literals;

namespace {

/// It travels in no time.
constexpr std::size_t small = 16 * 1024;

void finish(std::shared_ptr<Operation>& operation, std::error_code error, std::size_t bytes = 0)
{
    if (const auto done = std::exchange(operation, nullptr))
        done->finish(error, bytes);
}

class PipeStream final : public transport::Stream {
public:
    PipeStream(asio::io_context& context, std::shared_ptr<Pipe> pipe, int end, std::int64_t peer, bool local)
        : side_(NetworkSide::of(context)), pipe_(std::move(pipe)), end_(end), peer_(peer), local_(local)
    {
    }
    ~PipeStream() override { pipe_->close(end_); }

    void read_some(asio::mutable_buffer into, Handler handler) override
    {
        pipe_->read(end_, into, side_.begin(std::move(handler)));
    }
    std::size_t write_now(std::span<const asio::const_buffer> from) override
    {
        return world().may_write(side_.process) ? pipe_->write_now(end_, from) : 0;
    }
    void write_some(std::span<const asio::const_buffer> from, Handler handler) override
    {
        auto operation = side_.begin(std::move(handler));  // which holds what writes
        if (world().may_write(side_.process))
            pipe_->write(end_, from, std::move(operation));
    }
    void close() noexcept override { pipe_->close(end_); }
    [[nodiscard]] std::string peer() const override { return "pid " + std::to_string(peer_); }
    [[nodiscard]] bool local() const override { return local_; }
    [[nodiscard]] transport::Credentials credentials() const override
    {
        return {.role = local_ ? Role::owner : Role::member, .key = {}};
    }

private:
    NetworkSide& side_;
    std::shared_ptr<Pipe> pipe_;
    int end_;
    std::int64_t peer_;
    bool local_;
};

}  // namespace

void Pipe::read(int end, asio::mutable_buffer into, std::shared_ptr<Operation> operation)
{
    Way& way = ways_[1 - end];
    way.into = into;
    way.read = std::move(operation);
    if (cut_)
        return finish(way.read, asio::error::connection_reset);
    if (ways_[end].closed)  // by the death of a process whose handler still runs
        return finish(way.read, asio::error::operation_aborted);
    give(way);
    go_on_writing(way, 1 - end);
}

void Pipe::arrive(Way& way, std::string bytes)
{
    if (way.said) {
        way.unread -= bytes.size();
        bytes = way.said(bytes);
        way.unread += bytes.size();
    }
    if (way.arrived.empty())
        way.arrived = std::move(bytes);
    else
        way.arrived += bytes;
}

void Pipe::give(Way& way)
{
    if (!way.read)
        return;
    if (way.arrived.empty()) {
        if (way.ended)
            finish(way.read, asio::error::eof);
        return;
    }
    const auto bytes = std::min(way.arrived.size(), way.into.size());
    std::memcpy(way.into.data(), way.arrived.data(), bytes);
    way.arrived.erase(0, bytes);
    way.unread -= bytes;
    finish(way.read, {}, bytes);
}

std::size_t Pipe::write_now(int end, std::span<const asio::const_buffer> from)
{
    Way& way = ways_[end];
    if (cut_ || way.closed || ways_[1 - end].ended)
        return 0;
    std::string bytes;
    for (const auto& buffer : from) {
        const auto size = std::min(buffer.size(), nature_.room - way.unread - bytes.size());
        bytes.append(static_cast<const char*>(buffer.data()), size);
        if (size < buffer.size())
            break;
    }
    const auto size = bytes.size();
    way.unread += size;
    if (size > small)  // about 100 MB/s
        way.last = std::max(way.last, world().now()) + 10ns * size;
    if (size > 0)
        later(end, [this, end, bytes = std::move(bytes)]() mutable {
            world().note(bytes);
            arrive(ways_[end], std::move(bytes));
            give(ways_[end]);
        });
    return size;
}

void Pipe::write(int end, std::span<const asio::const_buffer> from, std::shared_ptr<Operation> operation)
{
    Way& way = ways_[end];
    way.from = from;
    way.write = std::move(operation);
    if (cut_ || way.closed || ways_[1 - end].ended)
        return finish(way.write, asio::error::broken_pipe);
    go_on_writing(way, end);
}

void Pipe::go_on_writing(Way& way, int end)
{
    if (!way.write)
        return;
    if (const auto bytes = write_now(end, way.from); bytes > 0)
        finish(way.write, {}, bytes);
}

void Pipe::later(int end, std::function<void()> what)
{
    Way& way = ways_[end];
    way.last = std::max(way.last, world().now() + nature_.latency + world().between(Duration(0), nature_.jitter));
    world().at(way.last, [self = shared_from_this(), what = std::move(what)] {
        if (!self->cut_)
            what();
    });
}

void Pipe::close(int end)
{
    Way &out = ways_[end], &in = ways_[1 - end];
    if (std::exchange(out.closed, true))
        return;
    finish(out.write, asio::error::operation_aborted);
    finish(in.read, asio::error::operation_aborted);
    later(end, [this, end] {
        ways_[end].ended = true;
        give(ways_[end]);
        finish(ways_[1 - end].write, asio::error::broken_pipe);
    });
}

void Pipe::cut()
{
    if (std::exchange(cut_, true))
        return;
    for (auto& way : ways_) {
        finish(way.read, asio::error::connection_reset);
        finish(way.write, asio::error::broken_pipe);
    }
}

std::unique_ptr<transport::Stream> make_stream(asio::io_context& context, std::shared_ptr<Pipe> pipe, int end,
                                               std::int64_t peer, bool local)
{
    return std::make_unique<PipeStream>(context, std::move(pipe), end, peer, local);
}

}  // namespace hive::simulation
