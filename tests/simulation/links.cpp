// Parses the ends of links from log lines.
#include "links.hpp"

#include <algorithm>
#include <optional>

namespace hive::simulation {

using namespace std::chrono_literals;

namespace {

/// A peer that sends nothing for 2 s is dead, and must send something every 500 ms.
constexpr auto nearly_dead = 1400ms;

/// "closed link to a1 at pid 1004: ..." and "lost receiver a1 at pid 1004: ..."; one that was never open has no name.
std::optional<std::string> peer_lost(const std::string& line)
{
    for (const std::string before : {"closed link to ", "lost receiver "})
        if (line.starts_with(before))
            if (const auto end = line.find(" at "); end != std::string::npos)
                return line.substr(before.size(), end - before.size());
    return std::nullopt;
}

/// The drone reports that a peer of this round has broken a rule.
bool blames(const std::string& line) { return line.starts_with("closed pid "); }

}  // namespace

void Links::mended(const std::string& name, Time now)
{
    std::erase_if(faults_, [&](const Fault& fault) { return fault.one == name && fault.from > now; });
    for (auto& fault : faults_)
        if (fault.one == name && fault.until == Time::max())
            fault.until = now + notice;
}

void Links::frozen(const std::string& name, Time now)
{
    Freeze& freeze = freezes_[name];
    if (now - freeze.until > 500ms)
        freeze.since = now;  // else it had no time to send anything in between
    faults_.push_back({name, {}, freeze.since + nearly_dead, Time::max()});
}

/// It detects only now what happened while it was frozen.
void Links::thawed(const std::string& name, Time now)
{
    Freeze& freeze = freezes_[name];
    freeze.until = now;
    std::vector<Fault> others;
    for (auto& fault : faults_)
        if ((fault.one == name || fault.other == name) && fault.until >= freeze.since && fault.until != Time::max())
            fault.until = std::max(fault.until, now + notice);
        else if (fault.until >= freeze.since)
            others.push_back({name, fault.one, now, now + notice});
    faults_.insert(faults_.end(), others.begin(), others.end());
    mended(name, now);
}

bool Links::may_end(const std::string& one, const std::string& other, Time now) const
{
    return std::ranges::any_of(faults_, [&](const Fault& fault) {
        const bool here = fault.one == one || fault.one == other;
        const bool both = fault.other.empty() || fault.other == one || fault.other == other;
        return here && both && fault.from <= now && now <= fault.until;
    });
}

void Links::logged(const std::string& drone, const std::string& line, Time now)
{
    if (std::ranges::any_of(liars_, [&](const auto& liar) { return line.find(liar) != std::string::npos; }))
        return;
    const auto peer = peer_lost(line);
    const bool unexpected = peer ? names_.contains(*peer) && !may_end(drone, *peer, now) : blames(line);
    if (unexpected)
        problems_.push_back("links: " + drone + " lost a link without a fault at its ends: " + line);
}

}  // namespace hive::simulation
