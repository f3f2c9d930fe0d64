// The way back from an event to its input.
#include <hive/event/door.hpp>
#include <hive/event/intake.hpp>
#include <hive/event/receipt.hpp>

#include <optional>
#include <utility>

namespace hive::event {

void Delivered::tell(bool worked, bool done, std::optional<Ending> ending) const
{
    door->post([weak = intake, generation = generation, number = number, worked, done, ending] {
        if (const auto to = weak.lock())
            to->heard(generation, number, worked, done, ending);
    });
}

/// Where the acknowledgement comes later the count does not wait for it.
void Custody::conclude(Ending ending) const
{
    ending_ = ending;
    if (credit_ || std::exchange(told_, true))
        return;
    delivered_.tell(false, false, ending);
}

void Custody::give_back_credit() const
{
    if (std::exchange(credit_, false))
        delivered_.tell(true, false, std::nullopt);
}

void give_receipt(Event& event, Delivered delivered)
{
    if (event.identity.lossless)
        event.receipt = std::make_shared<const WorkReceipt>(delivered);
    event.custody = std::make_shared<const Custody>(std::move(delivered), !event.identity.lossless);
    if (!event.receipt)
        event.receipt = event.custody;
}

void conclude(const Event& event, Ending ending)
{
    if (event.custody)
        static_cast<const Custody*>(event.custody.get())->conclude(ending);
}

void give_back_credit(Event& event)
{
    if (event.receipt && event.receipt == event.custody)
        static_cast<const Custody*>(event.custody.get())->give_back_credit();
    event.receipt.reset();
}

std::shared_ptr<const void> custody_of(const std::vector<Event>& set)
{
    if (set.size() == 1)
        return set.front().custody;
    auto all = std::make_shared<std::vector<std::shared_ptr<const void>>>();
    for (const auto& event : set)
        if (event.custody)
            all->push_back(event.custody);
    return all->size() > 1 ? all : all->empty() ? nullptr : all->front();
}

}  // namespace hive::event
