// Publisher, subscriber, server and client, whatever moves their bytes.
#include "roles.hpp"

#include "receiving.hpp"
#include "script.hpp"

#include <utility>

namespace hive::bench {
namespace {

constexpr Nanoseconds client_warms_up = 100 * millisecond;
constexpr int least_round_trips = 5;

void play_publisher(const Transport& transport, const Run& run, Board& board)
{
    Script script(run, transport.credit(run), board);
    transport.publisher(run)->publish(script);
    board.finished = true;
}

void play_subscriber(const Transport& transport, const Run& run, Board& board)
{
    Receiving receiving(run, board);
    transport.subscriber(run)->receive([&](std::span<const std::byte> frame) { return receiving.take(frame); });
}

void play_server(const Transport& transport, const Run& run, Board& board)
{
    const Cameras cameras(run.size);
    std::uint64_t sequence = 0;
    Usage begin;
    bool begun = false;
    const auto answer = [&](const Request& request, Frame& frame) {
        frame = cameras.frame(sequence++, request.header.kind);
        if (request.header.kind == Kind::measured && !std::exchange(begun, true))
            begin = own_usage();
        if (request.header.kind != Kind::end)
            return true;
        board.usage = own_usage() - begin;
        return false;
    };
    transport.server(run)->serve([&] { board.serving = true; }, answer);
}

/// Round trips of a client, one after the other.
class Asking {
public:
    Asking(const Transport& transport, const Run& run, Board& board)
        : check_(run.size), client_(transport.client(run)), mine_(board.received[0])
    {
    }

    void once(Kind kind)
    {
        const auto begin = now_ns();
        const bool right = client_->ask({{frame_magic, mine_.frames, begin, kind, 0}}, check_);
        const auto end = now_ns();
        mine_.bad += right ? 0 : 1;
        if (kind != Kind::measured)
            return;
        if (mine_.samples < most_samples) {
            mine_.available[mine_.samples] = static_cast<float>(end - begin) * 1e-3f;
            mine_.touched[mine_.samples++] = static_cast<float>(end - begin) * 1e-3f;
        }
        ++mine_.frames;
    }

    void many(Kind kind, Nanoseconds time)
    {
        const auto end = now_ns() + time;
        for (int i = 0; i < least_round_trips || now_ns() < end; ++i)
            once(kind);
    }

private:
    FrameCheck check_;
    std::unique_ptr<Client> client_;
    Received& mine_;
};

void play_client(const Transport& transport, const Run& run, Board& board)
{
    while (!board.serving)
        sleep_for(millisecond);
    Asking asking(transport, run, board);
    asking.many(Kind::warm, client_warms_up);
    Received& mine = board.received[0];
    const auto usage = own_usage();
    mine.first = now_ns();
    asking.many(Kind::measured, nanoseconds_of(run.seconds));
    mine.last = now_ns();
    mine.usage = own_usage() - usage;
    board.sent = mine.frames;
    asking.once(Kind::end);
    mine.done = true;
    board.finished = true;
}

[[noreturn]] void take_a_core()
{
    volatile std::uint64_t count = 0;
    for (;;)
        count = count + 1;
}

}  // namespace

void PushPublisher::publish(Script& script)
{
    while (const auto due = script.due()) {
        if (now_ns() < *due)
            sleep_until(*due);
        send(script.next());
    }
}

void play(const Transport& transport, const Run& run, Board& board)
{
    switch (run.role) {
    case Role::publisher: return play_publisher(transport, run, board);
    case Role::subscriber: return play_subscriber(transport, run, board);
    case Role::server: return play_server(transport, run, board);
    case Role::client: return play_client(transport, run, board);
    default: return take_a_core();
    }
}

}  // namespace hive::bench
