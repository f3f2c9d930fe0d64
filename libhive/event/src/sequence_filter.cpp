// A bounded memory of which answers have come.
#include <hive/event/sequence_filter.hpp>

namespace hive::event {

bool SequenceFilter::first(const Event& event)
{
    const Identity& identity = event.identity;
    if (identity.attempt == 0)
        return true;
    const auto [place, inserted] =
        seen_.emplace(identity.source + " " + identity.group, identity.epoch, identity.sequence, identity.turn,
                      event.kind + "." + event.output, identity.part);
    if (!inserted)
        return false;
    order_.push_back(*place);
    if (order_.size() > remembered) {
        seen_.erase(order_.front());
        order_.pop_front();
    }
    return true;
}

}  // namespace hive::event
