// Reads a swarm file. Its parts share the results so far.
#pragma once

#include "values.hpp"

#include <hive/name.hpp>
#include <hive/result.hpp>
#include <hive/transport/listen_address.hpp>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

namespace hive::swarm_file {

class Reader {
public:
    Reader(const Texts& texts, const InterfaceOfKind& interface_of)
        : mistakes_(texts), notes_(texts), interface_of_(interface_of)
    {
    }

    /// @param complete  false: an included file could not be read, and may have missing names
    void read(const Value& file, bool complete);
    /// Finds key files missing on this machine: those named in the file, and those that drones need to listen.
    void check_keys();
    /// Finds addresses to listen at that this machine does not have.
    void check_own_addresses();
    SwarmReading take();
    [[nodiscard]] Mistakes& mistakes() noexcept { return mistakes_; }

private:
    /// One entry of `drones`: one drone, or `count` of them.
    struct Entry {
        std::string name;
        Value value;
        SwarmDrone drone{};  ///< the common part
        std::optional<std::int64_t> count{};
        std::vector<std::string> hosts{};  ///< in turn
        std::optional<transport::Address> listening{};
    };

    // --- drones.cpp ---
    void read_drones(const Value& drones);
    std::optional<Entry> read_drone(const std::string& name, const Value& value);
    void read_kind(Members& members, Entry& entry);
    void read_hosts(Members& members, Entry& entry);
    void read_options(Members& members, Entry& entry);
    void read_settings(const Value& settings, Entry& entry);
    void check_setting(const Value& setting, const std::string& name, const Entry& entry);
    void expand(const Entry& entry);

    // --- addresses.cpp ---
    void read_addresses(Members& members, Entry& entry);
    std::optional<transport::Address> read_address(Members& members, std::string_view key, std::string& text);
    /// False: a mistake was written down.
    bool has_own_port(const SwarmDrone& drone, const Entry& entry);
    /// Checks that each machine has enough ports for its drones without one. Needs the engines.
    void check_free_ports();

    // --- connections.cpp ---
    void read_connection(const Value& connection);
    /// Expands a pattern of senders and one of receivers; ends at the first error, since the other matches of a glob
    /// would repeat it.
    void connect_all(const std::vector<Endpoint>& senders, const std::vector<Endpoint>& receivers,
                     const ConnectionOptions& options, bool shared, const Value& to);
    ConnectionOptions read_connection_options(Members& members);
    void check_clashes(Members& members);
    std::vector<Endpoint> ends_of(const std::string& text, const Value& value);
    std::vector<Endpoint> ends_like(const std::string& glob, const Value& value);
    [[nodiscard]] bool is_unclear(const std::string& text) const;
    void no_drone(const std::string& text, const Value& value);
    /// False: a mistake was written down.
    bool add_connection(SwarmConnection connection, const Value& to);
    void check_ports(SwarmConnection& connection);

    // --- engines.cpp ---
    void read_engine(const std::string& glob, const Value& value);
    void check_not_shadowed(const std::string& glob, const Value& value);
    void read_slurm(const Value& value);
    void read_slurm_options(const Value& list, const std::string& key);
    void read_directive(const Value& value);
    void read_slurm_option(const Value& value);
    /// Checks that each drone's engine supports its machine and its restart policy.
    void check_engines();

    /// As no_such(), with the names of things as candidates; only the first errors are compared with all names.
    template <class Things, class Name>
    Error misspelt(const std::string& text, std::string_view name, const Things& things, Name name_of,
                   const std::string& otherwise = {})
    {
        std::vector<std::string> candidates;
        if (compared_++ < most_compared)
            std::ranges::transform(things, std::back_inserter(candidates), name_of);
        return no_such(text, name, candidates, otherwise);
    }

    /// Is a drone of this entry started on this machine?
    [[nodiscard]] bool starts_here(const Entry& entry) const;
    /// Is one started on another machine, and reached over the network?
    [[nodiscard]] bool starts_elsewhere(const Entry& entry) const;
    /// The interface of a kind, cached; nothing if it is unknown.
    const Interface* interface(const std::string& kind);
    /// Records the kinds with an unknown interface: an error on this machine, a note for others.
    void tell_unknown_kinds();

    Mistakes mistakes_, notes_;
    const InterfaceOfKind& interface_of_;
    SwarmPlan plan_;
    std::map<std::string, Result<Interface>, std::less<>> interfaces_;
    std::vector<Entry> read_entries_;
    std::map<std::string, std::size_t, std::less<>> places_;   ///< of the drones in the plan, by name
    std::map<std::string, std::string, std::less<>> entries_;  ///< path of the entry, by the name of the drone
    std::set<std::string, std::less<>> counted_;               ///< entries with a count
    std::map<std::pair<std::string, std::uint16_t>, std::vector<std::pair<std::string, std::string>>>
        listening_;                    ///< by machine and port: the address and the drone
    std::set<std::string> connected_;  ///< "from to", with the known ports
    static constexpr int most_compared = 20;
    int compared_ = 0;               ///< misspelt names
    bool all_unclear_ = false;       ///< the drones, or an included file, could not be read
    std::set<std::string> unclear_;  ///< entries that could not be read, so that names like these may be missing
};

}  // namespace hive::swarm_file
