// From the status of a drone, its saved state, or its name.
#include "known_program.hpp"

#include <hive/event/home.hpp>
#include <hive/program.hpp>

#include <algorithm>

namespace hive {

KnownProgram known_program(Application& application, const std::string& drone)
{
    KnownProgram known;
    if (std::ranges::binary_search(application.drones(), drone))
        if (const auto answer = application.status(std::vector{drone}).at(0);
            const auto* status = value_of(answer.status)) {
            known.kind = status->order && !status->order->kind.empty() ? status->order->kind : status->kind;
            if (answer.place.host != Place::here)
                known.parameters = value_or_none(application.asked({drone}).at(0).result);
        }
    if (const auto state = event::Home(application.home()).read_state(drone)) {
        const Fields fields(*state, "the state of " + drone);
        if (known.kind.empty())
            known.kind = fields.text("kind");
        if (known.parameters.empty() && fields.has("parameters"))
            known.parameters = fields.object("parameters");
    }
    if (known.kind.empty())
        known.kind = kind_by_name(drone).value_or("");
    return known;
}

}  // namespace hive
