// The books of a subscriber.
#include "receiving.hpp"

namespace hive::bench {
namespace {

float micros(Nanoseconds time) { return static_cast<float>(time) * 1e-3f; }

}  // namespace

Receiving::Receiving(const Run& run, Board& board)
    : intervals_(run.test == Test::sync),
      check_(run.size),
      board_(board),
      mine_(board.received[static_cast<std::size_t>(run.index)])
{
}

bool Receiving::take(std::span<const std::byte> frame)
{
    const auto available = now_ns();
    const auto header = FrameCheck::header(frame);
    if (header.kind == Kind::probe) {
        mine_.ready = true;
        return true;
    }
    if (header.kind == Kind::end) {
        finish();
        return false;
    }
    if (!check_.whole(frame))
        ++mine_.bad;
    if (header.kind == Kind::measured)
        measure(header, available, now_ns());
    consumed(header.sequence);
    return true;
}

void Receiving::measure(const FrameHeader& header, Nanoseconds available, Nanoseconds touched)
{
    const bool first = mine_.frames == 0;
    if (first) {
        usage_ = own_usage();
        mine_.first = touched;
    } else if (header.sequence < expected_) {
        ++mine_.bad;
    }
    expected_ = header.sequence + 1;
    const auto since = intervals_ ? mine_.last : header.produced;
    if (mine_.samples < most_samples && !(intervals_ && first)) {
        mine_.available[mine_.samples] = micros(available - since);
        mine_.touched[mine_.samples++] = micros(touched - since);
    }
    ++mine_.frames;
    mine_.last = touched;
}

void Receiving::consumed(std::uint64_t sequence)
{
    mine_.consumed = sequence + 1;
    if (board_.listening) {
        ++board_.bell;
        futex_wake(board_.bell);
    }
}

void Receiving::finish()
{
    if (mine_.done)
        return;
    mine_.usage = own_usage() - usage_;
    mine_.done = true;
}

}  // namespace hive::bench
