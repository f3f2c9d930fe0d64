// Receiving from several outputs at once, in order when asked for.
#include "application_core.hpp"
#include "reorder.hpp"

#include <hive/event/mailbox.hpp>
#include <hive/event/sequence_filter.hpp>

#include <set>

namespace hive {
namespace {

constexpr auto exceptions_output = "exceptions";

/// Intakes whose events meet in one mailbox, taken by the user thread.
class MailboxCollector final : public Collector {
public:
    MailboxCollector(event::Module& module, const event::Home& home, CollectOptions options)
        : module_(module), home_(home), options_(std::move(options)), reorder_(options_.patience)
    {
    }
    ~MailboxCollector() override;

    /// Registers at one output; throws what the drone answers.
    void receive(const std::string& drone, const std::string& output, const ConnectionOptions& connection,
                 event::Clock::time_point deadline);
    /// Registers without waiting; failures are retried in the background.
    void follow(const std::string& drone, const std::string& output);

    std::optional<Event> next(std::chrono::milliseconds patience) override;
    [[nodiscard]] CollectCounts counts() const override;
    [[nodiscard]] bool ordered() const noexcept { return options_.ordered; }

private:
    std::shared_ptr<event::Intake> add(const std::string& drone, const std::string& output,
                                       const ConnectionOptions& connection);
    std::optional<Event> take(Event event);
    std::optional<Event> put_in_order(Event event);

    event::Module& module_;
    const event::Home& home_;
    CollectOptions options_;
    std::shared_ptr<event::Mailbox> mailbox_ = std::make_shared<event::Mailbox>();
    std::vector<std::shared_ptr<event::Intake>> intakes_;
    event::SequenceFilter filter_;
    Reorder reorder_;
    std::set<std::string> followed_;
    CollectCounts counts_;
};

MailboxCollector::~MailboxCollector()
{
    const auto remaining = std::make_shared<std::size_t>(intakes_.size());
    module_.call([&] {
        for (const auto& intake : intakes_)
            module_.remove_intake(intake, [remaining] { --*remaining; });
    });
    module_.loop().wait(event::Clock::now() + std::chrono::milliseconds(500), [&] { return *remaining == 0; });
}

std::shared_ptr<event::Intake> MailboxCollector::add(const std::string& drone, const std::string& output,
                                                     const ConnectionOptions& connection)
{
    const auto weak = std::make_shared<std::weak_ptr<event::Intake>>();
    const auto sink = [mailbox = mailbox_, weak](Event&& event) {
        const auto lost = mailbox->push(std::move(event));
        if (const auto intake = weak->lock())
            intake->lost += static_cast<std::int64_t>(lost);
    };
    const auto intake = module_.add_intake({.sender = drone,
                                            .output = output,
                                            .address = home_.address(drone),
                                            .input = drone + "." + output,
                                            .receiver = module_.self().name,
                                            .accepts = "*/*",
                                            .options = connection},
                                           sink);
    *weak = intake;
    return intakes_.emplace_back(intake);
}

void MailboxCollector::receive(const std::string& drone, const std::string& output, const ConnectionOptions& connection,
                               event::Clock::time_point deadline)
{
    const auto reply = std::make_shared<std::optional<event::Outcome>>();
    module_.call(
        [&] { add(drone, output, connection)->start([reply](const event::Outcome& outcome) { *reply = outcome; }); });
    std::optional<event::Outcome> outcome;
    module_.loop().wait(deadline, [&] { return (outcome = *reply).has_value(); });
    if (!outcome)
        throw Error(Errc::timeout, drone + "." + output + ": no answer in time");
    if (const auto* error = std::get_if<Error>(&*outcome))
        throw error->reworded(drone + "." + output + ": " + error->what());
    followed_.insert(drone);
}

void MailboxCollector::follow(const std::string& drone, const std::string& output)
{
    module_.call([&] { add(drone, output, {.transfer = Transfer::streaming, .group = {}, .lease = {}})->start({}); });
}

std::optional<Event> MailboxCollector::next(std::chrono::milliseconds patience)
{
    const auto deadline = event::Clock::now() + patience;
    for (;;) {
        reorder_.expire(event::Clock::now());
        if (auto event = reorder_.pop()) {
            ++counts_.received;
            return event;
        }
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

std::optional<Event> MailboxCollector::take(Event event)
{
    if (!filter_.first(event)) {
        ++counts_.duplicates;
        return std::nullopt;
    }
    if (options_.ordered)
        return put_in_order(std::move(event));
    return event;
}

std::optional<Event> MailboxCollector::put_in_order(Event event)
{
    // Acknowledged on arrival: a result that waits for its turn must not use up the credit that the missing one needs.
    event.receipt.reset();
    if (event.output == exceptions_output) {
        if (event.identity.sequence > 0)
            reorder_.fail(event.identity, event::Clock::now());
        return std::nullopt;
    }
    if (followed_.insert(event.identity.source).second && home_.alive(event.identity.source))
        follow(event.identity.source, exceptions_output);
    reorder_.push(std::move(event), event::Clock::now());
    return std::nullopt;
}

CollectCounts MailboxCollector::counts() const
{
    CollectCounts counts = counts_;
    counts.missing = reorder_.missing();
    counts.failed = reorder_.failed();
    for (const auto& intake : intakes_)
        counts.dropped += intake->lost;
    return counts;
}

}  // namespace

std::unique_ptr<Collector> Application::collect(const std::vector<Endpoint>& outputs, const CollectOptions& options)
{
    auto collector = std::make_unique<MailboxCollector>(core_->module, core_->home, options);
    const auto until = core_->deadline();
    for (const auto& output : outputs) {
        const auto [drone, port] = core_->with_output(output);
        if (options.ordered)
            collector->follow(drone, exceptions_output);
        collector->receive(drone, port, options.connection, until);
    }
    return collector;
}

std::unique_ptr<Collector> Application::exceptions(const std::vector<std::string>& drones)
{
    auto collector = std::make_unique<MailboxCollector>(core_->module, core_->home, CollectOptions{});
    for (const auto& drone : drones) {
        core_->require_running(drone);
        collector->receive(drone, exceptions_output, {.transfer = Transfer::streaming, .group = {}, .lease = {}},
                           core_->deadline());
    }
    return collector;
}

}  // namespace hive
