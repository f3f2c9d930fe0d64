// A connection of the simulated network: two streams of bytes with delays and faults.
#pragma once

#include "world.hpp"

#include <hive/transport/stream.hpp>

#include <array>
#include <string>

namespace hive::simulation {

class Pipe : public std::enable_shared_from_this<Pipe> {
public:
    struct Nature {
        Duration latency, jitter;
        std::size_t room;  ///< maximum number of bytes in flight
    };

    explicit Pipe(Nature nature) : nature_(nature) {}

    void read(int end, asio::mutable_buffer into, std::shared_ptr<Operation> operation);
    /// @return the number of accepted bytes, which are then in flight
    std::size_t write_now(int end, std::span<const asio::const_buffer> from);
    void write(int end, std::span<const asio::const_buffer> from, std::shared_ptr<Operation> operation);
    /// The other end gets the bytes in flight, and then the end of the stream.
    void close(int end);
    /// Bytes sent by this end arrive only after that time.
    void hold(int end, Time until) { ways_[end].last = std::max(ways_[end].last, until); }
    /// Filters the bytes that this end sends from now on.
    void rewrite(int end, Process::Said said) { ways_[end].said = std::move(said); }
    /// Both ends lose it now, with all bytes in flight.
    void cut();

private:
    /// From one end to the other.
    struct Way {
        std::string arrived;
        std::size_t unread = 0;  ///< written and not yet read
        bool closed = false, ended = false;
        Time last{};  ///< arrival of the last bytes in flight: bytes do not overtake
        std::shared_ptr<Operation> read, write;
        asio::mutable_buffer into;
        std::span<const asio::const_buffer> from;
        Process::Said said;
    };
    void later(int end, std::function<void()> what);
    static void arrive(Way& way, std::string bytes);
    static void give(Way& way);
    void go_on_writing(Way& way, int end);

    const Nature nature_;
    std::array<Way, 2> ways_;  ///< by the end that writes
    bool cut_ = false;
};

/// One end of a pipe.
std::unique_ptr<transport::Stream> make_stream(asio::io_context& context, std::shared_ptr<Pipe> pipe, int end,
                                               std::int64_t peer, bool local);

}  // namespace hive::simulation
