// Watching a key file.
#include <hive/transport/key_ring.hpp>

#include <hive/error.hpp>
#include <hive/platform/clock.hpp>

#include <algorithm>
#include <chrono>

namespace hive::transport {
namespace {

std::int64_t now_s()
{
    return std::chrono::duration_cast<std::chrono::seconds>(platform::WallClock::now().time_since_epoch()).count();
}

bool same(const struct stat& a, const struct stat& b)
{
    return a.st_dev == b.st_dev && a.st_ino == b.st_ino && a.st_size == b.st_size && a.st_mode == b.st_mode
           && a.st_mtim.tv_sec == b.st_mtim.tv_sec && a.st_mtim.tv_nsec == b.st_mtim.tv_nsec
           && a.st_ctim.tv_sec == b.st_ctim.tv_sec && a.st_ctim.tv_nsec == b.st_ctim.tv_nsec;
}

}  // namespace

const std::vector<SwarmKey>& KeyRing::own()
{
    refresh();
    return own_;
}

const std::vector<SwarmKey>& KeyRing::accepted()
{
    refresh();
    return accepted_;
}

bool KeyRing::accepts(const std::string& id, Role role)
{
    try {
        return std::ranges::any_of(accepted(), [&](const SwarmKey& key) { return key.id == id && key.role == role; });
    } catch (const Error&) {
        return false;  // no key is valid any more
    }
}

bool KeyRing::offers(const std::string& id, Role role)
{
    try {
        return std::ranges::any_of(own(), [&](const SwarmKey& key) { return key.id == id && key.role == role; });
    } catch (const Error&) {
        return false;
    }
}

void KeyRing::refresh()
{
    struct stat now {};
    if (::stat(file_.c_str(), &now) != 0 || !same(now, seen_) || own_.empty())
        read();
    drop_ended();
    if (own_.empty())
        throw Error(Errc::not_permitted, "the swarm key " + file_.string() + " has expired",
                    "copy the current key from another machine");
}

void KeyRing::read()
{
    struct stat now {};
    const bool there = ::stat(file_.c_str(), &now) == 0;  // before reading, so that a later change is detected
    try {
        own_ = read_key_file(file_);
        trouble_.clear();
    } catch (const Error& error) {
        if (own_.empty())
            throw;
        trouble_ = error.what();
    }
    seen_ = there ? now : decltype(seen_){};
    accepted_ = own_;
    for (const auto& key : own_)
        if (key.role == Role::member)
            accepted_.push_back(viewers_key(key));
}

void KeyRing::drop_ended()
{
    const auto ended = [now = now_s()](const SwarmKey& key) { return !holds(key, now); };
    std::erase_if(own_, ended);
    std::erase_if(accepted_, ended);
}

}  // namespace hive::transport
