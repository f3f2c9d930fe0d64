// Starting the prey, and watching it.
#include "prey.hpp"

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
        const auto begin = Clock::now();
        const Json answer = peer.ask(raw::status);
        return raw::error_of(answer).empty() && answer.at("result").at("pid") == pid()
               && Clock::now() - begin < within(100);
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
    while (!stop_) {
        const auto packet = peer_.next(Milliseconds(100));
        cut_off_ = peer_.ended();
        if (!packet || packet->type != raw::event)
            continue;
        const auto sequence = packet->json().at("seq").get<std::int64_t>();
        if (last != 0)
            lost_ += static_cast<int>(sequence - last - 1);
        last = sequence;
        ++received_;
    }
}

Milliseconds slowest_answer(raw::Peer& peer, int times)
{
    Milliseconds slowest{};
    for (int i = 0; i < times; ++i) {
        const auto begin = Clock::now();
        if (!raw::error_of(peer.ask(raw::status)).empty())
            return Milliseconds::max();
        slowest = std::max(slowest, std::chrono::duration_cast<Milliseconds>(Clock::now() - begin));
        peer.next(Milliseconds(20));
    }
    return slowest;
}

}  // namespace hostile
