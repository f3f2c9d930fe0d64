// Checks a swarm file with the interfaces of the programs on this machine.
#include <hive/program.hpp>
#include <hive/swarm_plan.hpp>

#include <algorithm>
#include <atomic>
#include <map>
#include <thread>
#include <variant>

namespace hive {
namespace {

using Told = std::variant<std::monostate, Interface, Error>;
using KindsTold = std::map<std::string, Told>;

/// After this many unknown kinds, errors no longer list the available ones: each list reads all directories.
constexpr int most_explained = 50;

Interface ask(const std::string& kind, std::chrono::milliseconds limit, std::atomic<int>& unknown)
{
    if (unknown >= most_explained && !is_python_file(kind) && !program_of(kind))
        throw Error(Errc::not_found, "there is no drone hive-" + kind);
    try {
        return interface_of(kind, limit);
    } catch (const Error& error) {
        unknown += error.code() == Errc::not_found;
        throw;
    }
}

/// Queries the programs of the kinds, a few at a time.
void ask_programs(KindsTold& kinds, std::chrono::milliseconds limit)
{
    constexpr std::size_t at_once = 8;
    const auto end = std::chrono::steady_clock::now() + limit;
    std::vector<KindsTold::value_type*> all;
    for (auto& kind : kinds)
        all.push_back(&kind);
    std::atomic<std::size_t> next = 0;
    std::atomic<int> unknown = 0;
    const auto ask_next = [&] {
        for (std::size_t i = next++; i < all.size(); i = next++)
            try {
                const auto left = end - std::chrono::steady_clock::now();
                all[i]->second = ask(all[i]->first, std::chrono::ceil<std::chrono::milliseconds>(left), unknown);
            } catch (...) {
                all[i]->second = current_error();
            }
    };
    std::vector<std::jthread> askers;
    for (std::size_t i = 0; i < std::min(at_once, all.size()); ++i)
        askers.emplace_back(ask_next);
}  // waits for them

/// The kinds whose interfaces the reader needs, including those of drones that it later drops.
KindsTold kinds_asked_for(std::string_view text, const SwarmContext& context)
{
    KindsTold kinds;
    read_swarm(
        text,
        [&](const std::string& kind) -> Interface {
            kinds.try_emplace(kind);
            throw Error(Errc::not_found, kind);
        },
        context);
    return kinds;
}

}  // namespace

SwarmReading check_swarm(std::string_view text, std::chrono::milliseconds limit, const SwarmContext& context)
{
    auto kinds = kinds_asked_for(text, context);
    ask_programs(kinds, limit);
    return read_swarm(
        text,
        [&](const std::string& kind) {
            const auto& told = kinds.at(kind);
            if (const auto* error = std::get_if<Error>(&told))
                throw *error;
            return std::get<Interface>(told);
        },
        context);
}

}  // namespace hive
