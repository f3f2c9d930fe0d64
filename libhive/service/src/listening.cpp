// Chooses ports, and reuses those of before a crash.
#include "listening.hpp"

#include <hive/transport/port_holder.hpp>

#include <algorithm>

namespace hive::service {

using transport::Address;

namespace {

/// The texts under a key of the state saved before a crash.
std::vector<std::string> saved_texts(const Json& state, const char* key)
{
    std::vector<std::string> texts;
    for (const auto& item : state.value(key, Json::array()))
        if (item.is_string())
            texts.push_back(item.get<std::string>());
    return texts;
}

/// The previous port at this host, then all ports to choose from.
std::vector<std::uint16_t> ports_to_try(const std::string& host, const std::vector<std::string>& before)
{
    std::vector<std::uint16_t> ports;
    for (const auto& text : before)
        if (const auto address = listen_address(text); address.host == host && address.port != 0)
            ports.push_back(address.port);
    for (auto port = transport::first_drone_port; port <= transport::last_drone_port; ++port)
        ports.push_back(port);
    return ports;
}

/// An advertised address without a port gets the port of the first listener.
std::string advertised(const std::string& text, const std::vector<std::string>& listening)
{
    auto address = listen_address(text);
    if (address.port == 0)
        address.port = transport::parse_address(listening.at(0)).port;
    return to_text(address);
}

}  // namespace

ListenWish wished(ListenWish told, const Json& state)
{
    const auto before = saved_texts(state, "listen");
    if (!told.listen.empty() || before.empty())
        return told;
    return {before, saved_texts(state, "advertise"), told.insecure || state.value("insecure", false),
            told.key.empty() ? state.value("key", "") : told.key,
            told.no_announce || state.value("no_announce", false)};
}

std::shared_ptr<transport::KeyRing> keys_for(const ListenWish& wish)
{
    if (wish.insecure)
        return nullptr;
    const auto file = wish.key.empty() ? default_key_file() : std::filesystem::path(wish.key);
    const auto keys =
        file.empty() ? nullptr : std::make_shared<transport::KeyRing>(file, !wish.key.empty() || key_file_is_named());
    if (!wish.key.empty())
        keys->own();
    for (const auto& text : wish.listen)
        if (listen_address(text).scheme == Address::Scheme::tcp)
            require_key_to_listen(file, "--listen " + text + ": ", "--insecure");
    return keys;
}

void Listening::begin(const ListenWish& wish, const Json& state)
{
    const auto before = saved_texts(state, "listen");
    held_ = {{}, {}, wish.insecure, wish.key, wish.no_announce};
    for (const auto& text : wish.listen) {
        held_.listen.push_back(to_text(listen(listen_address(text), before)));
        reporter_.log(LogLevel::info, "listening on " + held_.listen.back());
    }
    for (const auto& text : wish.advertise)
        held_.advertise.push_back(advertised(text, held_.listen));
    // Last, because peers treat a drone with a local socket as ready.
    places_ = {to_text(module_.listen(home_.address(module_.self().name)))};
    std::ranges::copy(held_.advertise.empty() ? held_.listen : held_.advertise, std::back_inserter(places_));
    announce();
}

/// A drone that accepts peers without a key has no key for a proof.
void Listening::announce()
{
    const auto spot = discovery::announced_spot(held_.listen, held_.advertise);
    if (!spot || held_.insecure || held_.no_announce)
        return;
    const auto& self = module_.self();
    announcer_ = std::make_unique<discovery::Announcer>(discovery::Announcer::Plan{
        .drone = self.name,
        .kind = self.kind,
        .epoch = self.epoch,
        .spot = *spot,
        .key = held_.key.empty() ? default_key_file() : std::filesystem::path(held_.key),
        .log = [this](LogLevel level, const std::string& text) { reporter_.log(level, text); }});
}

/// Listens at a given port, or on a unix socket.
Address Listening::listen_there(const Address& wanted)
try {
    return module_.listen(wanted);
} catch (const Error& error) {
    const bool taken = error.code() == Errc::name_taken && wanted.scheme == Address::Scheme::tcp;
    const auto holder = taken ? transport::holder_of_port(wanted.port) : "";
    if (holder.empty())
        throw;
    throw error.reworded(std::string(error.what()) + " by " + holder);
}

Address Listening::listen(const Address& wanted, const std::vector<std::string>& before)
{
    if (wanted.scheme != Address::Scheme::tcp || wanted.port != 0)
        return listen_there(wanted);
    for (const auto port : ports_to_try(wanted.host, before))
        try {
            return module_.listen({wanted.scheme, wanted.host, port});
        } catch (const Error& error) {
            if (error.code() != Errc::name_taken)
                throw;
        }
    throw Error(Errc::name_taken,
                "no port from " + std::to_string(transport::first_drone_port) + " to "
                    + std::to_string(transport::last_drone_port) + " is free",
                "name one: --listen tcp://" + wanted.host + ":PORT");
}

void Listening::tell(DroneOrder& order) const
{
    order.listen = held_.listen.empty() ? "" : held_.listen.front();
    order.advertise = held_.advertise.empty() ? "" : held_.advertise.front();
    order.key = held_.key;
    order.insecure = held_.insecure;
    order.no_announce = held_.no_announce;
}

Json Listening::saved() const
{
    return {{"listen", held_.listen},
            {"advertise", held_.advertise},
            {"insecure", held_.insecure},
            {"key", held_.key},
            {"no_announce", held_.no_announce}};
}

}  // namespace hive::service
