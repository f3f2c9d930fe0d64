// Starting the prey, and watching it.
#include "prey.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <stdexcept>

namespace hostile {

Prey::Prey(const std::string& kind, const std::vector<std::string>& settings)
    : process_(swarm_->drone(kind, "prey", settings))
{
}

bool Prey::well() const
{
    try {
        auto peer = meet("doctor");
        auto fastest = Milliseconds::max();
        for (int i = 0; i < 3 && fastest >= hive::test::stated(Milliseconds(2000)); ++i) {
            const auto begin = Clock::now();
            const Json answer = peer.ask(raw::status);
            if (!raw::error_of(answer).empty() || answer.at("result").at("pid") != pid())
                return false;
            fastest = std::min(fastest, std::chrono::duration_cast<Milliseconds>(Clock::now() - begin));
        }
        return fastest < hive::test::stated(Milliseconds(2000));
    } catch (const std::runtime_error&) {
        return false;
    }
}

Witness::Witness(const Prey& prey) : peer_(prey.meet("witness"))
{
    const Json registration{
        {"epoch", 1}, {"output", "image"}, {"receiver", "witness"}, {"options", {{"transfer", "stream"}}}};
    if (const Json answer = peer_.ask(raw::register_, registration, 1); !raw::error_of(answer).empty())
        throw std::runtime_error("the witness is refused: " + answer.dump());
    thread_ = std::thread([this] { receive(); });
}

Witness::~Witness()
{
    stop_ = true;
    thread_.join();
}

void Witness::receive()
{
    std::int64_t last = 0;
    auto turn = Clock::now();
    Clock::time_point held_up{};  // when this thread last came too late to take what there was
    while (!stop_) {
        const auto packet = peer_.next(Milliseconds(100));
        const auto now = Clock::now();
        if (now - turn > Milliseconds(300))
            held_up = now;
        turn = now;
        cut_off_ = peer_.ended();
        if (!packet || packet->type != raw::event)
            continue;
        const auto sequence = packet->json().at("seq").get<std::int64_t>();
        if (last != 0 && now - held_up > Milliseconds(1000))  // what had come before is read first
            lost_ += static_cast<int>(sequence - last - 1);
        last = sequence;
        ++received_;
    }
}

std::vector<Milliseconds> answer_times(raw::Peer& peer, int times)
{
    std::vector<Milliseconds> all;
    for (int i = 0; i < times; ++i) {
        const auto begin = Clock::now();
        const bool answered = raw::error_of(peer.ask(raw::status)).empty();
        all.push_back(answered ? std::chrono::duration_cast<Milliseconds>(Clock::now() - begin) : Milliseconds::max());
        peer.next(Milliseconds(20));
    }
    return all;
}

void check_answers(std::vector<Milliseconds> times)
{
    std::ranges::sort(times);
    REQUIRE_FALSE(times.empty());
    const auto most = times[times.size() * 9 / 10];
    MESSAGE("nine in ten of the answers within " << most.count() << " ms, all within " << times.back().count()
                                                 << " ms");
    CHECK(times.back() != Milliseconds::max());
    if (hive::test::sanitized())
        return;
    CHECK(most < Milliseconds(100));
}

}  // namespace hostile
