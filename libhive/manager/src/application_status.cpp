// Queries the status of drones, page by page.
#include "application_core.hpp"

#include <algorithm>

namespace hive {
namespace {

/// A limit, in case connections are added faster than they can be listed; listing also ends at the timeout of one
/// answer.
constexpr int most_pages = 64;

/// Adds the next page to the answer. @return whether there is another one
bool take_page(StatusAnswer& answer, const Answer& page)
try {
    auto& status = std::get<Status>(answer.status);
    auto next = status_from_json(value_or_throw(page.result));
    const auto listed = rows_listed(next);
    if (rows_listed(status) == 0)
        status = std::move(next);
    else
        add_page(status, std::move(next));
    return listed > 0 && status.rows_left_out > 0;
} catch (const Error& error) {
    answer.status = error;
    return false;
}

}  // namespace

void Application::Core::note_answers(const std::vector<StatusAnswer>& answers)
{
    std::vector<Place> answered;
    for (const auto& answer : answers)
        if (value_of(answer.status) && !answer.place.address.empty() && !is_here(answer.place))
            answered.push_back(answer.place);
    directory.list().answered(answered);
}

std::vector<StatusAnswer> Application::status(const std::vector<std::string>& drones)
{
    std::vector<StatusAnswer> answers;
    const auto places = core_->places_or_errors(drones);
    for (std::size_t i = 0; i < drones.size(); ++i) {
        const auto* place = std::get_if<Place>(&places[i]);
        answers.push_back({.drone = drones[i], .status = {}, .place = place ? *place : Place{}});
    }
    std::vector<StatusAnswer*> unfinished;
    std::ranges::transform(answers, std::back_inserter(unfinished), [](StatusAnswer& answer) { return &answer; });
    const auto until = core_->deadline();
    for (int page = 0; page < most_pages && !unfinished.empty() && (page == 0 || event::Clock::now() < until); ++page) {
        std::vector<std::string> names;
        std::vector<Json> headers;
        for (const auto* answer : unfinished) {
            names.push_back(answer->drone);
            const auto listed = rows_listed(std::get<Status>(answer->status));
            headers.push_back(listed > 0 ? Json{{"skip", listed}} : Json::object());
        }
        const auto pages = core_->ask_all(names, protocol::PacketType::status, headers);
        std::vector<StatusAnswer*> more;
        for (std::size_t i = 0; i < pages.size(); ++i)
            if (take_page(*unfinished[i], pages[i]))
                more.push_back(unfinished[i]);
        unfinished = std::move(more);
    }
    core_->note_answers(answers);
    return answers;
}

Status Application::status(const std::string& drone)
{
    core_->place(drone);
    return value_or_throw(status(std::vector{drone}).at(0).status);
}

}  // namespace hive
