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

/// How it ended, if that is known and was not told.
std::optional<Ending> Custody::news() const
{
    return concluded_ && !std::exchange(told_, true) ? std::optional(ending_) : std::nullopt;
}

/// Where the acknowledgement comes later the count does not wait for it.
void Custody::conclude(Ending ending) const
{
    ending_ = ending;
    concluded_ = true;
    if (!worked_)
        return;  // it is told together with that
    if (const auto ended = news())
        delivered_.tell(false, false, ended);
}

void Custody::give_back_credit() const
{
    if (!std::exchange(credit_, false))
        return;
    worked_ = true;
    delivered_.tell(true, false, std::nullopt);
}

void Custody::worked(bool last) const
{
    worked_ = true;
    if (last)
        credit_ = true;
    else
        delivered_.tell(true, false, news());
}

void give_receipt(Event& event, Delivered delivered)
{
    const auto custody = std::make_shared<const Custody>(std::move(delivered), !event.identity.lossless);
    event.custody = custody;
    if (event.identity.lossless)
        event.receipt = std::make_shared<const WorkReceipt>(custody);
    else
        event.receipt = custody;
}

void conclude(const Event& event, Ending ending)
{
    if (event.custody)
        static_cast<const Custody*>(event.custody.get())->conclude(ending);
}

namespace {

std::shared_ptr<Intake> intake_of(const Event& event)
{
    return event.custody ? static_cast<const Custody*>(event.custody.get())->intake() : nullptr;
}

}  // namespace

bool came_over(const Event& event, const Intake& intake) { return intake_of(event).get() == &intake; }

bool came_to_member(const Event& event)
{
    const auto intake = intake_of(event);
    return intake && !intake->spec().options.group.empty();
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
