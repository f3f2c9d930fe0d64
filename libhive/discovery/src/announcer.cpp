// Keeps one service of the daemon up to date.
#include <hive/discovery/announcer.hpp>

#include "daemon_thread.hpp"

#include <hive/error.hpp>
#include <hive/transport/key_ring.hpp>

#include <algorithm>
#include <mutex>

namespace hive::discovery {
namespace {

constexpr std::size_t most_of_a_label = 63;

/// A string list of libavahi.
class StringList {
public:
    StringList(const Avahi& avahi, const std::vector<std::string>& texts) : avahi_(avahi)
    {
        std::vector<const char*> words;
        for (const auto& text : texts)
            words.push_back(text.c_str());
        list_ = avahi.string_list_new_from_array(words.data(), static_cast<int>(words.size()));
    }
    ~StringList() { avahi_.string_list_free(list_); }
    StringList(const StringList&) = delete;
    StringList& operator=(const StringList&) = delete;
    [[nodiscard]] AvahiStringList* get() const { return list_; }

private:
    const Avahi& avahi_;
    AvahiStringList* list_;
};

}  // namespace

class Announcer::Work final : public DaemonUser {
public:
    explicit Work(Plan plan) : plan_(std::move(plan)), keys_(plan_.key) {}

    /// Writes no log line after this. Any thread.
    void be_quiet()
    {
        const std::lock_guard lock(mutex_);
        plan_.log = [](LogLevel, const std::string&) {};
    }

    bool begin(const Avahi& avahi, AvahiClient& client) override
    {
        avahi_ = &avahi;
        failed_ = false;
        const char* host = avahi.client_get_host_name(&client);
        host_ = host ? host : "";
        label_ = plan_.drone + "@" + host_;
        label_.resize(std::min(label_.size(), most_of_a_label));
        group_ = avahi.entry_group_new(
            &client,
            [](AvahiEntryGroup* group, AvahiEntryGroupState state, void* data) {
                static_cast<Work*>(data)->on_state(*group, state);
            },
            this);
        return group_ && publish(*group_);
    }
    void lost() override { group_ = nullptr; }
    [[nodiscard]] bool failed() const override { return failed_; }

    /// The key may have changed.
    bool tick() override
    {
        const auto txt = to_txt(announcement());
        if (txt == told_ || !group_)
            return true;
        told_ = txt;
        const StringList list(*avahi_, txt);
        return avahi_->entry_group_update_service_txt_strlst(group_, AVAHI_IF_UNSPEC, AVAHI_PROTO_UNSPEC,
                                                             AvahiPublishFlags{}, label_.c_str(), service_type, nullptr,
                                                             list.get())
               == 0;
    }

private:
    Announcement announcement()
    {
        Announcement result{.drone = plan_.drone, .kind = plan_.kind, .epoch = plan_.epoch, .at = plan_.spot.at};
        try {
            prove(result, {host_, plan_.spot.port}, keys_.own());
        } catch (const Error&) {
            // No key is valid any more: no peer can connect, so no peer need find the drone.
        }
        return result;
    }

    bool publish(AvahiEntryGroup& group)
    {
        told_ = to_txt(announcement());
        const StringList list(*avahi_, told_);
        const auto add = [this, &group, texts = list.get()] {
            return avahi_->entry_group_add_service_strlst(&group, AVAHI_IF_UNSPEC, AVAHI_PROTO_UNSPEC,
                                                          AvahiPublishFlags{}, label_.c_str(), service_type, nullptr,
                                                          nullptr, plan_.spot.port, texts);
        };
        int result = add();
        for (int tries = 0; result == AVAHI_ERR_COLLISION && tries < 100; ++tries) {
            rename();
            result = add();
        }
        if (result == 0)
            result = avahi_->entry_group_commit(&group);
        if (result != 0)
            say(LogLevel::warning, std::string("not announced on the local network: ") + avahi_->strerror(result));
        return result == 0;
    }

    /// Another drone of this name is announced, on this machine or on one with the same host name.
    void rename()
    {
        char* other = avahi_->alternative_service_name(label_.c_str());
        label_ = other ? other : label_ + "'";
        avahi_->free(other);
    }

    void on_state(AvahiEntryGroup& group, AvahiEntryGroupState state)
    {
        if (state == AVAHI_ENTRY_GROUP_ESTABLISHED)
            say(LogLevel::info, "announced on the local network as " + label_);
        if (state == AVAHI_ENTRY_GROUP_FAILURE)
            failed_ = true;
        if (state != AVAHI_ENTRY_GROUP_COLLISION)
            return;
        rename();
        failed_ = avahi_->entry_group_reset(&group) != 0 || !publish(group);
    }

    void say(LogLevel level, const std::string& text)
    {
        const std::lock_guard lock(mutex_);
        if (text != said_)
            plan_.log(level, said_ = text);
    }

    std::mutex mutex_;  ///< guards the log
    Plan plan_;
    std::string said_;
    // only on the thread
    transport::KeyRing keys_;
    const Avahi* avahi_ = nullptr;
    AvahiEntryGroup* group_ = nullptr;
    std::string host_, label_;
    std::vector<std::string> told_;
    bool failed_ = false;
};

Announcer::Announcer(Plan plan)
    : work_(std::make_shared<Work>(std::move(plan))), thread_(std::make_unique<DaemonThread>(work_))
{
}

Announcer::~Announcer()
{
    work_->be_quiet();
    thread_.reset();
}

}  // namespace hive::discovery
