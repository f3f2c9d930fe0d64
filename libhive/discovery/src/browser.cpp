// Browses the network from the first call on.
#include <hive/discovery/browser.hpp>

#include "daemon_thread.hpp"
#include "listening_note.hpp"

#include <hive/error.hpp>
#include <hive/transport/key_ring.hpp>

#include <condition_variable>
#include <map>
#include <mutex>
#include <tuple>

namespace hive::discovery {
namespace {

using Clock = std::chrono::steady_clock;

/// Maximum number of announcements to read, on all networks together.
constexpr std::size_t most_announcements = 1024;

/// The machines of a network answer faster, if at all.
constexpr std::chrono::milliseconds longest_wait_for_network{300};

/// One announcement on one network.
using Instance = std::tuple<AvahiIfIndex, AvahiProtocol, std::string, std::string>;

std::vector<std::string> texts_of(const AvahiStringList* list)
{
    std::vector<std::string> texts;
    for (; list; list = list->next)
        texts.emplace_back(reinterpret_cast<const char*>(list->text), list->size);
    return texts;
}

}  // namespace

class Browser::Work final : public DaemonUser {
public:
    /// @param known  the daemon that has browsed recently
    explicit Work(std::optional<std::uint32_t> known) : known_(known) {}

    bool begin(const Avahi& avahi, AvahiClient& client) override
    {
        avahi_ = &avahi;
        client_ = &client;
        failed_ = false;
        const auto daemon = avahi.client_get_local_service_cookie(&client);
        {
            const std::lock_guard lock(mutex_);
            daemon_ = daemon;
            asked_ = true;
            heard_at_ = Clock::now();
        }
        return avahi.service_browser_new(&client, AVAHI_IF_UNSPEC, AVAHI_PROTO_UNSPEC, service_type, nullptr,
                                         AvahiLookupFlags{}, &Work::on_browser, this)
               != nullptr;
    }
    void lost() override
    {
        resolvers_.clear();  // the client frees them
        const std::lock_guard lock(mutex_);
        seen_.clear();
        pending_ = 0;
        cache_told_ = all_told_ = asked_ = false;
    }
    void nobody() override
    {
        const std::lock_guard lock(mutex_);
        nobody_ = true;
        changed_.notify_all();
    }
    [[nodiscard]] bool failed() const override { return failed_; }

    // --- any thread ---
    /// Waits for the immediate answers of the network. @return the daemon, if it browsed for that long
    std::optional<std::uint32_t> await()
    {
        std::unique_lock lock(mutex_);
        const auto begin = Clock::now();
        const auto network = begin + longest_wait_for_network;
        heard_at_ = begin;
        const auto until = [&] { return std::min(heard_at_ + longest_silence, begin + longest_wait); };
        while (!is_settled() && (!cache_told_ || pending_ > 0) && Clock::now() < until())
            changed_.wait_until(lock, until());
        const bool quick = changed_.wait_until(lock, network, [&] { return is_settled(); });
        return quick || !cache_told_ ? std::nullopt : std::optional(daemon_);
    }
    [[nodiscard]] std::vector<Neighbour> of(const std::vector<SwarmKey>& keys)
    {
        std::vector<Neighbour> found;
        const std::lock_guard lock(mutex_);
        forget_proofs_of_other(keys);
        for (auto& [instance, seen] : seen_) {
            if (!seen.own)
                seen.own = is_proved(seen.neighbour.said, seen.service, keys);
            if (*seen.own)
                found.push_back(seen.neighbour);
        }
        return found;
    }

private:
    struct Seen {
        Service service;
        Neighbour neighbour;
        std::optional<bool> own{};  ///< proved by our keys; nothing: not checked yet
    };
    struct Resolving {
        Work* work = nullptr;
        AvahiServiceResolver* resolver = nullptr;
        Instance instance;
        bool pending = true;
    };

    /// Keeps verified proofs as long as the keys stay: a check costs microseconds, and each drone is looked up several
    /// times.
    void forget_proofs_of_other(const std::vector<SwarmKey>& keys)
    {
        std::vector<SwarmKey::Secret> secrets;
        for (const auto& key : keys)
            secrets.push_back(key.secret);
        if (secrets == proved_by_)
            return;
        proved_by_ = std::move(secrets);
        for (auto& [instance, seen] : seen_)
            seen.own.reset();
    }

    /// Has the daemon reported all? If it has browsed recently, its cache is complete.
    [[nodiscard]] bool is_settled() const
    {
        if (nobody_ && !asked_)
            return true;
        const bool complete = all_told_ || (known_ && *known_ == daemon_);
        return cache_told_ && pending_ == 0 && complete;
    }

    static void on_browser(AvahiServiceBrowser*, AvahiIfIndex interface, AvahiProtocol protocol,
                           AvahiBrowserEvent event, const char* name, const char*, const char* domain,
                           AvahiLookupResultFlags, void* data)
    {
        auto& work = *static_cast<Work*>(data);
        switch (event) {
        case AVAHI_BROWSER_NEW: return work.appeared({interface, protocol, name, domain});
        case AVAHI_BROWSER_REMOVE: return work.vanished({interface, protocol, name, domain});
        case AVAHI_BROWSER_CACHE_EXHAUSTED: return work.told(work.cache_told_);
        case AVAHI_BROWSER_ALL_FOR_NOW: return work.told(work.all_told_);
        case AVAHI_BROWSER_FAILURE: work.failed_ = true;
        }
    }

    void told(bool& what)
    {
        const std::lock_guard lock(mutex_);
        what = true;
        heard_at_ = Clock::now();
        changed_.notify_all();
    }

    void appeared(const Instance& instance)
    {
        if (resolvers_.size() >= most_announcements || resolvers_.contains(instance))
            return;
        auto& resolving = resolvers_[instance];
        resolving.work = this;
        resolving.instance = instance;
        const auto& [interface, protocol, name, domain] = instance;
        // Resolves an address of the announcing protocol. Otherwise the daemon would report the first known address,
        // which may be an IPv6 one that is valid on one link only.
        resolving.resolver =
            avahi_->service_resolver_new(client_, interface, protocol, name.c_str(), service_type, domain.c_str(),
                                         protocol, AvahiLookupFlags{}, &Work::on_resolver, &resolving);
        if (!resolving.resolver) {
            resolvers_.erase(instance);
            return;
        }
        const std::lock_guard lock(mutex_);
        ++pending_;
        heard_at_ = Clock::now();
    }

    void vanished(const Instance& instance)
    {
        const auto found = resolvers_.find(instance);
        if (found == resolvers_.end())
            return;
        set(found->second, std::nullopt);
        avahi_->service_resolver_free(found->second.resolver);
        resolvers_.erase(found);
    }

    /// Called again on each change.
    static void on_resolver(AvahiServiceResolver*, AvahiIfIndex, AvahiProtocol, AvahiResolverEvent event, const char*,
                            const char*, const char*, const char* host, const AvahiAddress* address, std::uint16_t port,
                            AvahiStringList* txt, AvahiLookupResultFlags flags, void* data)
    {
        auto& resolving = *static_cast<Resolving*>(data);
        if (event != AVAHI_RESOLVER_FOUND || !host || !address)
            return resolving.work->set(resolving, std::nullopt);
        char number[AVAHI_ADDRESS_STR_MAX];
        resolving.work->avahi_->address_snprint(number, sizeof number, address);
        const bool link_local = std::string_view(number).starts_with("fe80:");  // cannot be dialed without its link
        const Service service{host, port};
        const auto said = from_txt(texts_of(txt));
        const auto found = said && (!link_local || !said->at.empty())
                               ? neighbour(*said, service, number, (flags & AVAHI_LOOKUP_RESULT_LOCAL) != 0)
                               : std::nullopt;
        resolving.work->set(resolving, found ? std::optional(Seen{service, *found}) : std::nullopt);
    }

    void set(Resolving& resolving, const std::optional<Seen>& seen)
    {
        const std::lock_guard lock(mutex_);
        if (seen)
            seen_.insert_or_assign(resolving.instance, *seen);
        else
            seen_.erase(resolving.instance);
        pending_ -= std::exchange(resolving.pending, false) ? 1 : 0;
        heard_at_ = Clock::now();
        changed_.notify_all();
    }

    // only on the thread
    const Avahi* avahi_ = nullptr;
    AvahiClient* client_ = nullptr;
    std::map<Instance, Resolving> resolvers_;
    bool failed_ = false;
    // under the mutex
    std::mutex mutex_;
    std::condition_variable changed_;
    const std::optional<std::uint32_t> known_;
    std::uint32_t daemon_ = 0;
    std::map<Instance, Seen> seen_;
    std::vector<SwarmKey::Secret> proved_by_;
    Clock::time_point heard_at_{};
    std::size_t pending_ = 0;  ///< announcements being resolved for the first time
    bool asked_ = false, cache_told_ = false, all_told_ = false, nobody_ = false;
};

Browser::Browser(std::filesystem::path key, std::filesystem::path note)
    : note_(std::move(note)), keys_(key.empty() ? nullptr : std::make_unique<transport::KeyRing>(std::move(key)))
{
}

Browser::~Browser() = default;

void Browser::begin()
{
    if (!thread_) {
        const ListeningNote note(note_);
        work_ = std::make_shared<Work>(note.daemon());
        thread_ = std::make_unique<DaemonThread>(work_);
        if (const auto daemon = work_->await())
            note.write(*daemon);
    }
}

std::vector<Neighbour> Browser::found()
try {
    if (!keys_ || (!thread_ && !has_system_bus()))
        return {};                    // before reading keys, which initialises OpenSSL and takes a millisecond
    const auto& keys = keys_->own();  // throws without keys
    begin();
    return without_repetitions(work_->of(keys));
} catch (const Error&) {
    return {};  // without a key there is no swarm on the network
}

}  // namespace hive::discovery
