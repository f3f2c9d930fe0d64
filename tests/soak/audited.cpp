// Comparing the rows with what is known.
#include "audited.hpp"

#include <hive/status.hpp>

namespace hive::soak {
namespace {

using mixtures::Problems;

std::string drone_of(const std::string& end) { return end.substr(0, end.find('.')); }

std::string name_of(const Json& row)
{
    return row.at("from").get<std::string>() + " -> " + row.at("to").get<std::string>();
}

std::int64_t accounted(const Json& row)
{
    auto sum = row.at("in_flight").get<std::int64_t>();
    for (std::size_t fate = 0; fate < fates; ++fate)
        sum += row.at(token(static_cast<Fate>(fate))).get<std::int64_t>();
    return sum;
}

std::int64_t count_of(const std::map<std::string, std::int64_t>& counts, const std::string& drone)
{
    const auto found = counts.find(drone);
    return found == counts.end() ? 0 : found->second;
}

class Judge {
public:
    explicit Judge(const Known& known) : known_(known) {}

    void look(const Json& row)
    {
        if (!row.at("came").is_null() && row.at("came") != accounted(row))
            complain(row, "does not add up");
        if (!row.at("differences").empty())
            complain(row, "has ends that differ");
        if (known_.at_rest && !row.at("in_flight").is_null() && row.at("in_flight") != 0)
            complain(row, "has events in flight, and the swarm is at rest");
        for (const auto& loss : row.at("losses"))
            if (loss.at("promised").get<bool>())
                blame(row, loss);
        const bool lost = row.at("lost").get<std::int64_t>() != 0, good = row.at("verdict") == "ok";
        if (good != (!lost && row.at("differences").empty()))
            complain(row, "has a verdict that does not follow from it");
        if (row.at("state") == "both ends")
            whole_.insert({drone_of(row.at("from")), drone_of(row.at("to"))});
    }

    Problems finish()
    {
        if (!known_.at_rest)
            return std::move(problems_);
        for (const auto& [drone, count] : known_.failures)
            if (count_of(blamed_, drone) != count)
                problems_.push_back("audit: the collector has " + std::to_string(count) + " exceptions of " + drone
                                    + ", and audit counts " + std::to_string(count_of(blamed_, drone))
                                    + " events abandoned there");
        for (const auto& pair : known_.connections)
            if (!whole_.contains(pair))
                problems_.push_back("audit: " + pair.first + " -> " + pair.second + " has no row with both ends");
        return std::move(problems_);
    }

private:
    void complain(const Json& row, const std::string& what)
    {
        problems_.push_back("audit: " + name_of(row) + " " + what + ": " + row.dump());
    }

    /// Only code that threw and events that were given up are losses, and for each the collector has an exception.
    void blame(const Json& row, const Json& loss)
    {
        const auto at = loss.at("at").get<std::string>();
        const auto events = loss.at("events").get<std::int64_t>();
        const bool watches = row.at("to") == mixtures::watcher + ".image";
        if (loss.at("fate") != "abandoned" && watches && events <= known_.breaks)
            return;
        if (loss.at("fate") != "abandoned")
            return complain(row, "is accused of a loss, and nothing is missing");
        if (at == drone_of(row.at("from"))) {
            if (known_.at_rest && events > count_of(known_.given_up, at))
                complain(row, "has more events given up than exceptions came");
            return;
        }
        blamed_[at] += events;
        if (!known_.failures.contains(at) && known_.at_rest)
            complain(row, "has events abandoned at a drone that threw nothing");
    }

    const Known& known_;
    Problems problems_;
    std::map<std::string, std::int64_t> blamed_;  ///< events abandoned at a receiver
    std::set<std::pair<std::string, std::string>> whole_;
};

}  // namespace

Problems misjudged(const Json& rows, const Known& known)
{
    Judge judge(known);
    for (const auto& row : rows)
        judge.look(row);
    return judge.finish();
}

}  // namespace hive::soak
