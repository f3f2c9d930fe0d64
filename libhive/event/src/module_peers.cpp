// Handles registrations and requests of peers, and their limits.
#include <hive/event/module.hpp>
#include <hive/name.hpp>

namespace hive::event {

using protocol::PacketType;

namespace {

constexpr std::size_t most_registrations = 64;  ///< of one peer
constexpr std::size_t most_requests = 32;       ///< of one peer, in progress

/// For a request without a deadline.
constexpr std::int64_t usual_deadline_ms = 5000;
/// The maximum of any request.
constexpr std::int64_t longest_deadline_ms = 24 * 3600 * 1000;

/// The common fields of all requests.
struct RequestFields {
    RequestFields(const protocol::Packet& packet, const Json& header)
        : fields(header, protocol::token(packet.type)), id(fields.integer("id", 0, max_json_integer))
    {
    }
    [[nodiscard]] Clock::time_point deadline() const
    {
        const auto given = fields.integer_or("deadline_ms", 0, max_json_integer, usual_deadline_ms);
        return Clock::now() + std::chrono::milliseconds(std::min(given, longest_deadline_ms));
    }

    Fields fields;
    std::int64_t id;
};

std::vector<std::string> names_of(const std::list<Outlet>& outlets)
{
    std::vector<std::string> names;
    for (const auto& outlet : outlets)
        names.push_back(outlet.port().name);
    return names;
}

}  // namespace

void Module::on_packet(Link& link, const protocol::Packet& packet)
{
    if (packet.type == PacketType::request) {
        const auto request = protocol::request_from_text(packet.header_text());
        for (auto& outlet : outlets_)
            outlet.request(link, packet.channel, request);
        return arm();
    }
    Json header = parse_json(packet.header_text());
    switch (packet.type) {
    case PacketType::register_receiver: return on_register(link, packet, header);
    case PacketType::deregister: return on_deregister(link, packet, header);
    default: return on_request_packet(link, packet, std::move(header));
    }
}

Outlet& Module::outlet(const std::string& name)
{
    for (auto& outlet : outlets_)
        if (outlet.port().name == name)
            return outlet;
    throw no_such(options_.self.name + " has no output " + name, name, names_of(outlets_));
}

void Module::on_register(Link& link, const protocol::Packet& packet, const Json& header)
{
    // Far more than the drones of one machine need when all of them reconnect.
    if (!registrations_.pass(without_port(link.connection().peer()), Clock::now()))
        throw Error(Errc::refused, "more than 4096 registrations within 10 s");
    const RequestFields request(packet, header);
    const auto id = request.id;
    try {
        static_cast<void>(request.deadline());  // only read: a registration is answered at once
        const auto registration = protocol::registration_from_json(header);
        require_free(link, packet.channel);
        Outlet& sender = outlet(registration.output);
        sender.require_fit(link, registration);
        sender.add(link.shared_from_this(), packet.channel, registration, [&](const Welcome& welcome) {
            on_subscribers();
            link.answer(id, confirmation(sender, welcome));
        });
        release_held();
    } catch (const Error& error) {
        link.answer(id, error);
    }
    arm();
}

/// The answer to a registration: its place, and the progress of shared work.
Json Module::confirmation(const Outlet& sender, const Welcome& welcome) const
{
    Json json{{"type", sender.port().type},
              {"kind", options_.self.kind},
              {"epoch", options_.self.epoch},
              {"place", welcome.place},
              {"taken", welcome.taken}};
    if (welcome.group)
        json.update({{"turn", welcome.group->turn}, {"closed", welcome.group->closed}});
    Json shares = Json::array();
    for (const auto& intake : intakes_)
        if (const auto standing = intake->standing())
            shares.push_back({{"of", standing->share.of},
                              {"epoch", standing->share.epoch},
                              {"turn", standing->share.turn},
                              {"closed", standing->share.closed},
                              {"open", standing->open}});
    if (!shares.empty())
        json["shares"] = std::move(shares);
    return json;
}

void Module::require_free(const Link& link, std::uint16_t channel) const
{
    if (channel == 0)
        throw Error(Errc::invalid_argument, "register: channel 0 is invalid");
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
    const RequestFields request(packet, header);
    try {
        static_cast<void>(request.deadline());
        bool found = false;
        for (auto& outlet : outlets_)
            found = outlet.remove(link, packet.channel) || found;
        if (!found)
            throw Error(Errc::not_found, "nothing is registered on channel " + std::to_string(packet.channel));
        on_subscribers();
        link.answer(request.id, Json::object());
    } catch (const Error& error) {
        link.answer(request.id, error);
    }
}

void Module::on_request_packet(Link& link, const protocol::Packet& packet, Json header)
{
    const RequestFields request(packet, header);
    const auto id = request.id;
    const auto handler = handlers_.find(packet.type);
    if (handler == handlers_.end())
        return link.answer(id, Error(Errc::unsupported, options_.self.name + " does not support the request "
                                                            + std::string(protocol::token(packet.type))));
    if (link.asked.size() >= most_requests)
        return link.answer(id, Error(Errc::refused, std::to_string(most_requests)
                                                        + " requests of yours are in progress; wait for an answer"));
    try {
        const auto asked = std::make_shared<Asked>(packet.type, id, request.deadline());
        const auto answer = answer_to(link, asked);
        try {
            handler->second({.peer = link.peer().name,
                             .peer_epoch = link.peer().epoch,
                             .role = link.credentials().role,
                             .peer_place = link.connection().peer(),
                             .header = std::move(header),
                             .body = packet.body,
                             .asked = asked,
                             .answer = answer,
                             .connection = &link,
                             .connected = [weak = link.weak_from_this()] {
                                 const auto asker = weak.lock();
                                 return asker && asker->open();
                             }});
        } catch (const Error& error) {
            answer(error);
        }
    } catch (const Error& error) {
        link.answer(id, error);
    }
    arm();
}

/// Sends the first answer to a request, from any thread.
OnOutcome Module::answer_to(Link& link, const std::shared_ptr<Asked>& asked)
{
    link.asked.push_back(asked);
    const auto send = [weak = link.weak_from_this(), asked](Outcome outcome) {
        const auto to = weak.lock();
        if (!to || !asked->answer())
            return;
        std::erase(to->asked, asked);
        if (to->open())
            to->answer(asked->id(), std::move(outcome));
    };
    return [weak = weak_loop(), send](Outcome outcome) {
        const auto loop = weak.lock();
        if (loop && loop->has_turn())
            send(std::move(outcome));
        else if (loop)
            loop->post([send, outcome = std::move(outcome)] { send(outcome); });
    };
}

void Module::expire_asked(Link& link, Clock::time_point now)
{
    for (const auto& asked : std::vector(link.asked)) {
        if (!asked->expire(now))
            continue;
        std::erase(link.asked, asked);
        link.answer(asked->id(),
                    Error(Errc::timeout, options_.self.name + " was busy until the deadline of this "
                                             + std::string(protocol::token(asked->type())) + " had passed"));
    }
}

}  // namespace hive::event
