// Receives from several outputs at once, in order if requested.
#include "application_core.hpp"
#include "reorder.hpp"

#include <hive/event/mailbox.hpp>
#include <hive/event/answer_filter.hpp>
#include <hive/event/ticket.hpp>

#include <set>

namespace hive {
namespace {

constexpr auto exceptions_output = "exceptions";
constexpr auto make_sure_timeout = std::chrono::seconds(2);  // a drone answers within one

/// The connections of a collector. They share ownership, also while they close.
struct Inputs {
    std::vector<std::shared_ptr<event::Intake>> intakes{};  ///< network side
    event::EndOfInputs end{event::EndOfInputs::Of::collector};
};

/// Network side: an end counts once its sender has been queried, since another source may have been set meanwhile.
void make_sure(event::Module& module, const std::shared_ptr<Inputs>& inputs,
               const std::shared_ptr<event::Mailbox>& mailbox)
{
    module.make_sure(make_sure_timeout, [mailbox, weak = std::weak_ptr(inputs), end = inputs->end.doubt()] {
        if (const auto alive = weak.lock(); alive && alive->end.confirm(end))
            mailbox->nudge();
    });
}

/// Merges the events of its intakes in one mailbox for the user thread.
class MailboxCollector final : public Collector {
public:
    /// @param sets  the application's count of sets
    MailboxCollector(event::Module& module, const Directory& directory, const std::atomic<std::int64_t>& sets,
                     CollectOptions options)
        : module_(module),
          directory_(directory),
          sets_(sets),
          sets_before_(sets),
          options_(std::move(options)),
          reorder_(options_.reorder_timeout)
    {
    }
    ~MailboxCollector() override;

    /// Registers at one output; throws the error that the drone answers.
    /// @param drone  the name used here
    /// @param wait  waits until a condition, called with the turn, or the deadline
    void receive(const std::string& drone, const Place& place, const std::string& output,
                 const ConnectionOptions& connection, const std::function<void(const std::function<bool()>&)>& wait);
    /// Receives the exceptions of the drones of this name, once; failures to register are retried in the background.
    void hear_exceptions(const std::string& drone);

    std::optional<Event> next(std::chrono::milliseconds timeout) override;
    [[nodiscard]] std::optional<std::string> ended() override;
    [[nodiscard]] CollectCounts counts() const override;
    [[nodiscard]] std::vector<InputStatus> inputs() const override;
    [[nodiscard]] bool ordered() const noexcept { return options_.ordered; }

private:
    std::shared_ptr<event::Intake> add(const std::string& drone, const Place& place, const std::string& output,
                                       const ConnectionOptions& connection);
    std::optional<Event> take(Event event);
    std::optional<Event> put_in_order(Event event);
    void expect(const Json& confirmation);
    void follow_those_on_the_way(const Event& event);

    event::Module& module_;
    const Directory& directory_;
    const std::atomic<std::int64_t>& sets_;
    std::int64_t sets_before_;  ///< when the end was last confirmed
    CollectOptions options_;
    std::shared_ptr<event::Mailbox> mailbox_ = std::make_shared<event::Mailbox>();
    std::shared_ptr<Inputs> inputs_ = std::make_shared<Inputs>();
    event::AnswerFilter filter_;
    Reorder reorder_;
    std::set<std::string> followed_;
    CollectCounts counts_;
};

MailboxCollector::~MailboxCollector()
{
    const auto remaining = std::make_shared<std::size_t>();
    module_.call([&] {
        *remaining = inputs_->intakes.size();
        for (const auto& intake : std::exchange(inputs_->intakes, {}))
            module_.remove_intake(intake, [remaining] { --*remaining; });
    });
    // A closing input waits for lossless events in hand, and no caller will take those still here.
    mailbox_->discard([](const Event&) { return true; });
    module_.loop().wait(event::Clock::now() + std::chrono::milliseconds(500), [&] { return *remaining == 0; });
}

std::shared_ptr<event::Intake> MailboxCollector::add(const std::string& drone, const Place& place,
                                                     const std::string& output, const ConnectionOptions& connection)
{
    const auto sink = [mailbox = mailbox_](Event&& event) { mailbox->push(std::move(event)); };
    const auto look = [&module = module_, mailbox = mailbox_, weak = std::weak_ptr(inputs_)] {
        if (const auto inputs = weak.lock(); inputs && inputs->end.look(inputs->intakes))
            make_sure(module, inputs, mailbox);
    };
    const auto intake = module_.add_intake({.sender = place.drone,
                                            .output = output,
                                            .address = transport::parse_address(place.address),
                                            .input = drone + "." + output,
                                            .receiver = module_.self().name,
                                            .accepts = "*/*",
                                            .options = connection},
                                           sink, look);
    inputs_->intakes.push_back(intake);
    look();  // until its end is known, not all have ended
    return intake;
}

void MailboxCollector::receive(const std::string& drone, const Place& place, const std::string& output,
                               const ConnectionOptions& connection,
                               const std::function<void(const std::function<bool()>&)>& wait)
{
    const auto reply = std::make_shared<std::optional<event::Outcome>>();
    module_.call([&] {
        add(drone, place, output, connection)->start([reply](const event::Outcome& outcome) { *reply = outcome; });
    });
    std::optional<event::Outcome> outcome;
    wait([&] { return (outcome = *reply).has_value(); });
    if (!outcome)
        throw Error(Errc::timeout, drone + "." + output + ": no answer in time");
    if (const auto* error = std::get_if<Error>(&*outcome))
        throw error->reworded(drone + "." + output + ": " + error->what());
    expect(std::get<Json>(*outcome));
}

/// The drone reported the standing of its groups.
void MailboxCollector::expect(const Json& confirmation)
{
    const Fields fields(confirmation, "confirmation");
    if (!fields.has("shares"))
        return;
    for (const auto& item : fields.array("shares")) {
        const Fields share(item, "share");
        std::vector<std::int64_t> open;
        for (const auto& turn : share.array("open"))
            open.push_back(json_integer(turn).value_or(0));
        reorder_.expect({.of = share.text("of"),
                         .epoch = share.integer("epoch", 0, max_json_integer),
                         .turn = share.integer("turn", 0, max_json_integer),
                         .closed = share.integer("closed", 0, max_json_integer)},
                        open);
    }
}

void MailboxCollector::hear_exceptions(const std::string& drone)
{
    if (followed_.contains(drone))
        return;
    const ConnectionOptions stream{.transfer = Transfer::streaming, .group = {}, .lease = {}};
    for (const auto& place : directory_.all_of(drone)) {
        followed_.insert(drone);
        module_.call([&] { add(drone, place, exceptions_output, stream)->start({}); });
    }
}

std::optional<Event> MailboxCollector::next(std::chrono::milliseconds timeout)
{
    const auto deadline = event::Clock::now() + timeout;
    for (;;) {
        reorder_.expire(event::Clock::now());
        if (auto event = reorder_.pop()) {
            ++counts_.received;
            return event;
        }
        if (ended())
            return std::nullopt;
        const auto due = reorder_.deadline();
        auto item = module_.next(*mailbox_, due ? std::min(*due, deadline) : deadline);
        if (item)
            if (auto event = take(std::move(std::get<Event>(*item)))) {
                ++counts_.received;
                return event;
            }
        if (!item && event::Clock::now() >= deadline)
            return std::nullopt;
    }
}

std::optional<std::string> MailboxCollector::ended()
{
    if (const std::int64_t sets = sets_; std::exchange(sets_before_, sets) != sets)
        module_.call([this] {
            if (inputs_->end.text())
                make_sure(module_, inputs_, mailbox_);
        });
    auto text = inputs_->end.text();  // first: when the end is known, all earlier events are in the mailbox
    if (!text || mailbox_->events() > 0)
        return std::nullopt;
    reorder_.finish(event::Clock::now());
    return reorder_.empty() ? text : std::nullopt;
}

std::optional<Event> MailboxCollector::take(Event event)
{
    if (!filter_.first(event)) {
        ++counts_.duplicates;
        conclude(event, event::Ending::duplicate);
        if (options_.ordered)
            reorder_.skip(event.identity, event::Clock::now());
        return std::nullopt;
    }
    if (options_.ordered)
        return put_in_order(std::move(event));
    return event;
}

std::optional<Event> MailboxCollector::put_in_order(Event event)
{
    // Acknowledged on arrival: a result that waits for its turn must not use the credit that the missing one needs.
    event.ticket = {};
    follow_those_on_the_way(event);
    if (event.output == exceptions_output) {
        if (event.identity.sequence > 0)
            reorder_.fail(event.identity, event::Clock::now());
    } else if (!reorder_.push(std::move(event), event::Clock::now())) {
        ++counts_.duplicates;
    }
    return std::nullopt;
}

/// Drones that processed one event may have failed at others.
void MailboxCollector::follow_those_on_the_way(const Event& event)
{
    hear_exceptions(event.identity.source);
    for (const auto& hop : event.identity.hops)
        hear_exceptions(hop.drone);
    for (const auto& share : event.identity.shares)
        hear_exceptions(std::string(share.sender()));
}

CollectCounts MailboxCollector::counts() const
{
    CollectCounts counts = counts_;
    counts.missing = reorder_.missing();
    counts.missing_turns = reorder_.missing_turns();
    counts.failed = reorder_.failed();
    for (const auto& input : inputs())
        counts.dropped += input.dropped;
    return counts;
}

std::vector<InputStatus> MailboxCollector::inputs() const
{
    std::vector<InputStatus> rows;
    module_.call([&] {
        for (const auto& intake : inputs_->intakes)
            rows.push_back(intake->status());
    });
    return rows;
}

/// All drones upstream of these.
std::set<std::string> upstream_of(Application& application, std::vector<std::string> drones)
{
    std::set<std::string> found;
    while (!drones.empty()) {
        const auto answers = application.status(std::exchange(drones, {}));
        for (const auto& answer : answers)
            if (const auto* status = value_of(answer.status))
                for (const auto& input : status->inputs)
                    if (auto name = parse_endpoint(input.from).drone; !name.empty() && found.insert(name).second)
                        drones.push_back(std::move(name));
    }
    return found;
}

}  // namespace

std::unique_ptr<Collector> Application::collect(const std::vector<Endpoint>& outputs, const CollectOptions& options)
{
    auto collector = std::make_unique<MailboxCollector>(core_->module, core_->directory, core_->sets, options);
    const auto until = core_->deadline();
    std::vector<std::string> drones;
    for (const auto& output : outputs) {
        const auto [drone, port] = core_->with_output(output);
        if (options.ordered)
            collector->hear_exceptions(drone_of(drone));
        collector->receive(drone, core_->place(drone), port, options.connection,
                           [&](const auto& done) { core_->wait(until, done); });
        drones.push_back(drone);
    }
    if (options.ordered)
        for (const auto& drone : upstream_of(*this, drones))
            collector->hear_exceptions(drone);
    return collector;
}

std::unique_ptr<Collector> Application::exceptions(const std::vector<std::string>& drones)
{
    auto collector = std::make_unique<MailboxCollector>(core_->module, core_->directory, core_->sets, CollectOptions{});
    for (const auto& drone : drones)
        collector->receive(drone, core_->place(drone), exceptions_output,
                           {.transfer = Transfer::streaming, .group = {}, .lease = {}},
                           [until = core_->deadline(), this](const auto& done) { core_->wait(until, done); });
    return collector;
}

}  // namespace hive
