// A query is pending until its answer is taken.
#include "inquiry.hpp"

#include <algorithm>
#include <utility>

namespace hive {
namespace {

StatusAnswer answer_of(const std::string& drone, const Place& place, const event::Outcome& outcome)
try {
    if (const auto* error = error_of(outcome))
        throw named(drone, *error);
    return {.drone = drone, .status = status_from_json(std::get<Json>(outcome)), .place = place};
} catch (const Error& error) {
    return {.drone = drone, .status = error, .place = place};
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
    core_.module.loop().call([&] {  // the thread with the turn writes replies
        for (auto& [drone, asked] : asked_)
            if (asked.reply && asked.reply->has_value()) {
                answers.push_back(answer_of(drone, asked.place, asked.reply->value()));
                asked.reply.reset();
                asked.next = Clock::now() + pause_;
            }
    });
    core_.note_answers(answers);
    return answers;
}

void Inquiry::wait(Clock::time_point until, const std::vector<int>& descriptors)
{
    const auto answered = [](const auto& entry) {
        const auto& reply = entry.second.reply;
        return reply && reply->has_value();
    };
    if (std::ranges::find(descriptors, -1) != descriptors.end())
        return;
    core_.module.loop().wait(
        until, [&] { return std::ranges::any_of(asked_, answered); }, descriptors);
}

}  // namespace hive
