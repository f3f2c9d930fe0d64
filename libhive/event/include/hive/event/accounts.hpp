// What each receiver and group of an output has had, counted on beyond its registrations (SPEC.md, section 8).
#pragma once

#include <hive/status.hpp>
#include <hive/transfer.hpp>

#include <functional>
#include <map>
#include <string>
#include <utility>

namespace hive::event {

struct Account {
    Ledger ledger;
    ConnectionOptions options;
    std::int64_t registration = 0;  ///< epoch of the newest
    int registrations = 0;          ///< now
    std::uint64_t lost = 0;         ///< order in which accounts lost their last registration
};

/// An account stays where it is as long as it is not closed, so a line or a group may write into its ledger.
class Accounts {
public:
    using Key = std::pair<std::string, std::string>;  ///< receiver, group
    using InUse = std::function<bool(const Key&)>;    ///< does a kept place write into that account?
    static constexpr std::size_t most_old = 64;       ///< of receivers that were lost
    static Key of_group(const std::string& name) { return {"group " + name, name}; }

    /// For one more registration.
    Account& open(const std::string& receiver, std::int64_t epoch, const ConnectionOptions& options);
    /// A registration ended. Who left by itself has no account any longer; of those that were lost the oldest goes when
    /// there are too many.
    void close(const Key& key, bool left, const InUse& in_use);
    /// That of all members of a group together.
    Account& group(const std::string& name);
    void forget_group(const std::string& name) { accounts_.erase(of_group(name)); }

    [[nodiscard]] auto begin() const { return accounts_.begin(); }
    [[nodiscard]] auto end() const { return accounts_.end(); }

private:
    void forget_old(const InUse& in_use);

    std::map<Key, Account> accounts_;
    std::uint64_t order_ = 0;
};

}  // namespace hive::event
