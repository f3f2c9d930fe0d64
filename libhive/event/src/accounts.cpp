// Which accounts are open, and which are forgotten.
#include <hive/event/accounts.hpp>

namespace hive::event {

Account& Accounts::open(const std::string& receiver, std::int64_t epoch, const ConnectionOptions& options)
{
    Account& account = accounts_[{receiver, options.group}];
    account.options = options;
    account.registration = epoch;
    ++account.registrations;
    return account;
}

Account& Accounts::group(const std::string& name)
{
    Account& account = accounts_[of_group(name)];
    account.options.group = name;
    return account;
}

void Accounts::close(const Key& key, bool left, const InUse& in_use)
{
    const auto found = accounts_.find(key);
    if (found == accounts_.end() || --found->second.registrations > 0)
        return;
    if (left && !in_use(key)) {
        accounts_.erase(found);
        return;
    }
    found->second.lost = ++order_;
    forget_old(in_use);
}

void Accounts::forget_old(const InUse& in_use)
{
    std::map<std::uint64_t, Key> old;  // the oldest first
    for (const auto& [key, account] : accounts_)
        if (account.lost != 0 && account.registrations == 0 && !in_use(key))
            old.emplace(account.lost, key);
    for (auto oldest = old.begin(); old.size() > most_old; oldest = old.erase(oldest))
        accounts_.erase(oldest->second);
}

}  // namespace hive::event
