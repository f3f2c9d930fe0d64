// Comparing rows of the same account.
#include "picture.hpp"
#include "watch.hpp"

#include <algorithm>

namespace hive::mixtures {
namespace {

bool went_back(const EdgeStatus& was, const EdgeStatus& is)
{
    bool back = is.events.total() < was.events.total();
    for (std::size_t i = 0; i < fates; ++i)
        back = back || is.events.of(static_cast<Fate>(i)) < was.events.of(static_cast<Fate>(i));
    return back;
}

bool went_back(const InputStatus& was, const InputStatus& is)
{
    return is.received < was.received || is.processed < was.processed || is.abandoned < was.abandoned
           || is.duplicates < was.duplicates || is.discarded < was.discarded || is.dropped < was.dropped
           || is.unmatched < was.unmatched;
}

void compare(const OutputStatus& was, const OutputStatus& is, const std::string& output, Problems& problems)
{
    if (is.produced < was.produced || is.unreceived < was.unreceived)
        problems.push_back("monotone: " + output + " had produced " + std::to_string(was.produced) + ", and now "
                           + std::to_string(is.produced));
    for (const auto& edge : is.edges)
        for (const auto& old : was.edges)
            if (edge.receiver == old.receiver && edge.registration == old.registration && went_back(old, edge))
                problems.push_back("monotone: " + output + " -> " + edge.receiver + " had " + to_text(old)
                                   + "; and now " + to_text(edge));
}

void compare(const Status& was, const Status& is, Problems& problems)
{
    for (const auto& output : is.outputs)
        for (const auto& old : was.outputs)
            if (output.name == old.name)
                compare(old, output, is.name + "." + output.name, problems);
    for (const auto& input : is.inputs)
        for (const auto& old : was.inputs)
            if (input.input == old.input && input.from == old.from && input.registration == old.registration
                && went_back(old, input))
                problems.push_back("monotone: " + input.from + " -> " + is.name + " had " + to_text(old) + "; and now "
                                   + to_text(input));
}

}  // namespace

Problems Watch::look(const Statuses& statuses)
{
    Problems problems;
    for (const auto& [name, status] : statuses) {
        const auto before = before_.find(name);
        if (before != before_.end() && before->second.epoch == status.epoch)
            compare(before->second, status, problems);
    }
    before_ = statuses;
    return problems;
}

}  // namespace hive::mixtures
