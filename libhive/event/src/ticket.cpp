// Reports the outcome of an event to its input.
#include <hive/event/intake.hpp>
#include <hive/event/loop.hpp>
#include <hive/event/ticket.hpp>

#include <optional>
#include <utility>

namespace hive {

Ticket::Ticket(std::shared_ptr<event::Acknowledgement> owed, bool processing)
    : owed_(std::move(owed)), processing_(processing)
{
    if (processing_)
        owed_->begin();
}

Ticket::Ticket(const Ticket& other) : Ticket(other.owed_, other.processing_) {}

Ticket::Ticket(Ticket&& other) noexcept
    : owed_(std::move(other.owed_)), processing_(std::exchange(other.processing_, false))
{
}

Ticket& Ticket::operator=(Ticket other) noexcept
{
    owed_.swap(other.owed_);
    std::swap(processing_, other.processing_);
    return *this;
}

Ticket::~Ticket()
{
    if (processing_)
        owed_->stop(owed_.use_count() == 1);
}

void Ticket::stop_processing()
{
    if (std::exchange(processing_, false))
        owed_->stop(false);
}

}  // namespace hive

namespace hive::event {

Acknowledgement::Acknowledgement(std::weak_ptr<Loop> loop, std::weak_ptr<Intake> intake, std::int64_t generation,
                                 std::int64_t number)
    : loop_(std::move(loop)), intake_(std::move(intake)), generation_(generation), number_(number)
{
}

Acknowledgement::~Acknowledgement() { tell(tells_both_, true, told_ ? std::nullopt : std::optional(ending_)); }

/// @param processed  the next event may be requested
/// @param done  this event may be acknowledged
/// @param ending  its outcome, for the counters; nothing: not now
void Acknowledgement::tell(bool processed, bool done, std::optional<Ending> ending) const
{
    const auto loop = loop_.lock();
    if (!loop)
        return;  // this event needs no acknowledgement, or the module has ended
    loop->post([weak = intake_, generation = generation_, number = number_, processed, done, ending] {
        if (const auto to = weak.lock())
            to->heard(generation, number, processed, done, ending);
    });
}

/// The outcome, if it is known and was not reported.
std::optional<Ending> Acknowledgement::news()
{
    return concluded_ && !std::exchange(told_, true) ? std::optional(ending_) : std::nullopt;
}

/// The count does not wait for a later acknowledgement.
void Acknowledgement::conclude(Ending ending)
{
    ending_ = ending;
    concluded_ = true;
    if (!processed_)
        return;  // stop() reports it, or the destructor
    if (const auto ended = news())
        tell(false, false, ended);
}

void Acknowledgement::stop(bool last)
{
    if (--processing_ > 0)
        return;
    processed_ = true;
    if (last)
        tells_both_ = true;
    else
        tell(true, false, news());
}

void conclude(const Event& event, Ending ending)
{
    if (const auto& owed = event.ticket.owed())
        owed->conclude(ending);
}

namespace {

std::shared_ptr<Intake> intake_of(const Event& event)
{
    const auto& owed = event.ticket.owed();
    return owed ? owed->intake() : nullptr;
}

}  // namespace

std::function<bool(const Event&)> came_over(const Intake& intake)
{
    return [&intake](const Event& event) { return intake_of(event).get() == &intake; };
}

bool came_to_member(const Event& event)
{
    const auto intake = intake_of(event);
    return intake && !intake->spec().options.group.empty();
}

Ticket causes(const std::vector<Event>& set)
{
    if (set.size() == 1)
        return set.front().ticket.of_cause();
    std::shared_ptr<Acknowledgement> all;
    for (const auto& event : set)
        if (const auto& owed = event.ticket.owed()) {
            all = all ? all : std::make_shared<Acknowledgement>();
            all->hold(owed);
        }
    return {std::move(all), false};
}

}  // namespace hive::event
