// What peers ask of a module: registrations, requests, and the limits on both.
#include <hive/event/module.hpp>
#include <hive/name.hpp>

namespace hive::event {

using protocol::PacketType;

namespace {

constexpr std::size_t most_registrations = 64;  ///< of one peer
constexpr std::size_t most_requests = 32;       ///< of one peer, under way

std::vector<std::string> names_of(const std::list<Outlet>& outlets)
{
    std::vector<std::string> names;
    for (const auto& outlet : outlets)
        names.push_back(outlet.port().name);
    return names;
}

}  // namespace

void Module::on_packet(Link& link, const protocol::Packet& packet, const Json& header)
{
    switch (packet.type) {
    case PacketType::register_receiver: return on_register(link, packet, header);
    case PacketType::deregister: return on_deregister(link, packet, header);
    case PacketType::request: {
        const auto request = protocol::request_from_json(header);
        for (auto& outlet : outlets_)
            outlet.request(link, packet.channel, request);
        return arm();
    }
    default: return on_request_packet(link, packet, header);
    }
}

Outlet& Module::outlet(const std::string& name)
{
    for (auto& outlet : outlets_)
        if (outlet.port().name == name)
            return outlet;
    const auto near = nearest(name, names_of(outlets_));
    throw Error(Errc::not_found,
                options_.self.name + " has no output " + name + (near.empty() ? "" : "; did you mean " + near + "?"));
}

void Module::on_register(Link& link, const protocol::Packet& packet, const Json& header)
{
    const auto id = Fields(header, "register").integer("id", 0, max_json_integer);
    try {
        const auto registration = protocol::registration_from_json(header);
        require_free(link, packet.channel);
        Outlet& sender = outlet(registration.output);
        sender.require_fit(link, registration);
        // The confirmation leaves before the first event.
        link.answer(id,
                    Json{{"type", sender.port().type}, {"kind", options_.self.kind}, {"epoch", options_.self.epoch}});
        sender.add(link.shared_from_this(), packet.channel, registration);
    } catch (const Error& error) {
        link.answer(id, error);
    }
    arm();
}

void Module::require_free(const Link& link, std::uint16_t channel) const
{
    if (channel == 0)
        throw Error(Errc::invalid_argument, "register: channel 0 is no channel");
    std::size_t registrations = 0;
    for (const auto& outlet : outlets_) {
        if (outlet.has(link, channel))
            throw Error(Errc::invalid_argument, "register: channel " + std::to_string(channel) + " is in use");
        registrations += outlet.receivers(link);
    }
    if (registrations >= most_registrations)
        throw Error(Errc::refused,
                    options_.self.name + " takes " + std::to_string(most_registrations) + " registrations of one peer");
}

void Module::on_deregister(Link& link, const protocol::Packet& packet, const Json& header)
{
    const auto id = Fields(header, "deregister").integer("id", 0, max_json_integer);
    bool found = false;
    for (auto& outlet : outlets_)
        found = outlet.remove(link, packet.channel) || found;
    if (found)
        link.answer(id, Json::object());
    else
        link.answer(id, Error(Errc::not_found, "nothing is registered on channel " + std::to_string(packet.channel)));
}

void Module::on_request_packet(Link& link, const protocol::Packet& packet, const Json& header)
{
    const auto id = Fields(header, protocol::token(packet.type)).integer("id", 0, max_json_integer);
    const auto handler = handlers_.find(packet.type);
    if (handler == handlers_.end())
        return link.answer(id, Error(Errc::unsupported, options_.self.name + " does not know the request "
                                                            + std::string(protocol::token(packet.type))));
    if (link.under_way >= most_requests)
        return link.answer(id, Error(Errc::refused, std::to_string(most_requests)
                                                        + " requests of yours are under way; wait for an answer"));
    ++link.under_way;
    const auto send = [weak = link.weak_from_this(), id](const Outcome& outcome) {
        const auto to = weak.lock();
        if (!to || !to->open())
            return;
        --to->under_way;
        to->answer(id, outcome);
    };
    const auto answer = [door = door_, send](const Outcome& outcome) {
        if (door->inside())
            return send(outcome);
        door->post([send, outcome] { send(outcome); });
    };
    const auto connected = [weak = link.weak_from_this()] {
        const auto asker = weak.lock();
        return asker && asker->open();
    };
    try {
        handler->second({link.peer().name, header, packet.body, answer, connected});
    } catch (const Error& error) {
        send(error);
    }
}

}  // namespace hive::event
