// The descriptors are watched by the io_context that receives the answers, so that there is one wait for all.
#include "inquiry.hpp"

#include <asio/posix/stream_descriptor.hpp>

#include <algorithm>
#include <list>
#include <utility>

namespace hive {
namespace {

using namespace std::chrono_literals;

constexpr auto pause_between_questions = 10ms;

StatusAnswer answer_of(const std::string& drone, const Place& place, const event::Outcome& outcome)
try {
    if (const auto* error = std::get_if<Error>(&outcome))
        throw named(drone, *error);
    return {.drone = drone, .status = status_from_json(std::get<Json>(outcome)), .error = {}, .place = place};
} catch (const Error& error) {
    return {.drone = drone, .status = {}, .error = error, .place = place};
}

}  // namespace

void Inquiry::ask(const std::vector<std::string>& drones, std::chrono::milliseconds limit)
{
    const auto now = Clock::now();
    std::vector<std::string> due;
    std::ranges::copy_if(drones, std::back_inserter(due), [&](const std::string& drone) {
        const auto& asked = asked_[drone];
        return !asked.reply && now >= asked.next;
    });
    const auto places = core_.places_or_errors(due);
    for (std::size_t i = 0; i < due.size(); ++i) {
        auto& asked = asked_[due[i]];
        const auto* place = std::get_if<Place>(&places[i]);
        asked.place = place ? *place : Place{};
        asked.reply = place ? core_.send(*place, protocol::PacketType::status, Json::object(), {}, now + limit)
                            : std::make_shared<std::optional<event::Outcome>>(std::get<Error>(places[i]));
    }
}

std::vector<StatusAnswer> Inquiry::take()
{
    std::vector<StatusAnswer> answers;
    core_.module.loop().call([&] {  // replies are written by who has the turn
        for (auto& [drone, asked] : asked_)
            if (asked.reply && asked.reply->has_value()) {
                answers.push_back(answer_of(drone, asked.place, asked.reply->value()));
                asked.reply.reset();
                asked.next = Clock::now() + pause_between_questions;
            }
    });
    core_.note_answers(answers);
    return answers;
}

void Inquiry::wait(Clock::time_point until, const std::vector<int>& descriptors)
{
    auto& loop = core_.module.loop();
    const auto readable = std::make_shared<bool>(false);
    std::list<asio::posix::stream_descriptor> watched;
    loop.call([&] {
        for (const int descriptor : descriptors)
            watched.emplace_back(loop.context(), descriptor)
                .async_wait(asio::posix::stream_descriptor::wait_read,
                            [readable](const std::error_code& error) { *readable = *readable || !error; });
    });
    loop.wait(until, [&] {
        return *readable || std::ranges::any_of(asked_, [](const auto& entry) {
            const auto& reply = entry.second.reply;
            return reply && reply->has_value();
        });
    });
    loop.call([&] {
        for (auto& one : watched)
            one.release();  // it is whoever gave it who closes it
        watched.clear();
    });
}

}  // namespace hive
