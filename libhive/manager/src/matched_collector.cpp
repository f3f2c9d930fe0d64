// Receives sets of matching events.
#include "application_core.hpp"

#include <hive/event/matcher.hpp>

#include <algorithm>

namespace hive {
namespace {

/// Passes the events of a collector through a matcher.
class CollectorOfSets final : public MatchedCollector {
public:
    CollectorOfSets(std::unique_ptr<Collector> collector, const std::vector<std::string>& inputs, Match match)
        : collector_(std::move(collector)), matcher_(inputs, match)
    {
    }

    std::optional<std::vector<Event>> next(std::chrono::milliseconds timeout) override
    {
        const auto deadline = event::Clock::now() + timeout;
        for (;;) {
            matcher_.expire(event::Clock::now());
            if (auto set = matcher_.pop())
                return set;
            if (ended())
                return matcher_.pop();
            const auto until = std::min(deadline, matcher_.deadline().value_or(deadline)) - event::Clock::now();
            if (auto event = collector_->next(
                    std::max(std::chrono::ceil<std::chrono::milliseconds>(until), std::chrono::milliseconds(0))))
                matcher_.push(std::move(*event), event::Clock::now());
            else if (event::Clock::now() >= deadline)
                return std::nullopt;
        }
    }

    [[nodiscard]] std::optional<std::string> ended() override
    {
        auto text = collector_->ended();
        if (text)
            matcher_.finish();
        return matcher_.ready() ? std::nullopt : text;
    }

    [[nodiscard]] MatchCounts counts() const override { return matcher_.counts(); }
    [[nodiscard]] CollectCounts received() const override { return collector_->counts(); }
    [[nodiscard]] std::vector<InputStatus> inputs() const override { return collector_->inputs(); }

private:
    std::unique_ptr<Collector> collector_;
    event::Matcher matcher_;
};

}  // namespace

std::unique_ptr<MatchedCollector> Application::collect_matched(const std::vector<Endpoint>& outputs, Match match,
                                                               const CollectOptions& options)
{
    std::vector<Endpoint> ends;
    std::vector<std::string> inputs;
    for (const auto& output : outputs) {
        ends.push_back(core_->with_output(output));
        inputs.push_back(ends.back().drone + "." + ends.back().port);
        if (std::ranges::count(inputs, inputs.back()) > 1)
            throw Error(Errc::invalid_argument, inputs.back() + " is named twice: a set has one event of each output");
    }
    if (inputs.size() < 2)
        throw Error(Errc::invalid_argument, "a set takes two outputs or more");
    if (options.ordered)
        throw Error(Errc::invalid_argument, "matched sets cannot be ordered");
    return std::make_unique<CollectorOfSets>(collect(ends, options), inputs, match);
}

}  // namespace hive
