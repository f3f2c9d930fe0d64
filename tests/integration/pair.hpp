// A drone that has two senders: a real camera, and a liar that is a peer of this program.
#pragma once

#include "prey.hpp"

#include <doctest/doctest.h>

#include <fcntl.h>
#include <filesystem>
#include <optional>
#include <string>
#include <unistd.h>

namespace hostile {

/// Holds the name of a drone as a living drone does, so that hivectl looks for it.
class Claim {
public:
    explicit Claim(const std::filesystem::path& lock)
        : descriptor_(::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600))
    {
        struct flock whole {};
        whole.l_type = F_WRLCK;
        REQUIRE(::fcntl(descriptor_, F_OFD_SETLK, &whole) == 0);
    }
    ~Claim() { ::close(descriptor_); }
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;

private:
    int descriptor_;
};

/// Of an event as the liar sends it, but for `changed`.
inline Json event_header(Json changed = Json::object())
{
    Json json{{"sender", "liar"}, {"kind", "camera"}, {"output", "image"}, {"type", "image/jpeg"},
              {"source", "liar"}, {"epoch", 1},       {"seq", 1}};
    json.update(changed);
    return json;
}

/// A drone (face, if not said) that receives a stream from a real camera, and is told to receive from a liar too.
class Pair {
public:
    explicit Pair(const Json& options = Json::object(), const std::string& kind = "face") : prey(kind)
    {
        tell({{"from", {{"drone", "cam"}, {"output", "image"}}},
              {"input", "image"},
              {"options", {{"transfer", "stream"}}}});
        REQUIRE(raw::error_of(asker_.next_of(raw::confirmation, within(3000)).value().json()) == "");
        tell({{"from", {{"drone", "liar"}, {"output", "image"}}}, {"input", "image"}, {"options", options}});
        (void)serve();
        REQUIRE(raw::error_of(asker_.next_of(raw::confirmation, within(3000)).value().json()) == "");
    }

    /// The drone's next connection to the liar, past its registration. The one before ends.
    raw::Peer& serve()
    {
        peer_.reset();
        auto peer = listener_.accept(within(3000));
        REQUIRE(peer);
        peer->send(raw::hello_packet("liar", "camera"));
        REQUIRE(peer->next_of(raw::hello, within(1000)));
        const auto registration = peer->next_of(raw::register_, within(1000));
        REQUIRE(registration);
        channel = registration->channel;
        epoch = registration->json().at("epoch");
        const Json result{{"type", "image/jpeg"}, {"kind", "camera"}, {"epoch", 1}};
        peer->send(
            raw::packet(raw::confirmation, 0, Json{{"id", registration->json().at("id")}, {"result", result}}.dump()));
        peer_.emplace(std::move(*peer));
        return *peer_;
    }

    std::string event(const Json& header, const std::string& body = "x", int type = raw::event) const
    {
        return raw::packet(type, channel, header.dump(), body);
    }

    /// What the drone says of its connection to the camera.
    Json from_camera() const
    {
        auto doctor = prey.meet("doctor");
        for (const Json inputs = doctor.ask(raw::status).at("result").at("inputs"); const auto& row : inputs)
            if (row.at("from") == "cam.image")
                return row;
        return nullptr;
    }
    /// What the camera says of it.
    Json to_prey() const
    {
        auto doctor = raw::Peer::meet(prey.swarm().home() / "cam.sock", "doctor");
        return doctor.ask(raw::status).at("result").at("outputs").at(0).at("edges").at(0);
    }
    /// Did the other connection go on without a break or a loss?
    void check_camera() const
    {
        const auto before = to_prey().value("acknowledged", 0);
        CHECK(hive::test::eventually([&] { return to_prey().value("acknowledged", 0) > before + 1; }, within(3000)));
        CHECK_FALSE(to_prey().contains("dropped"));
        CHECK_FALSE(to_prey().contains("skipped"));
        CHECK(from_camera().at("connected") == true);
        CHECK_FALSE(from_camera().contains("dropped"));
        CHECK(from_camera().value("received", 0) >= before);
    }

    Prey prey;
    int channel = 0;
    std::int64_t epoch = 0;

private:
    void tell(const Json& connect)
    {
        Json fields = connect;
        fields["id"] = ++id_;
        REQUIRE(asker_.send(raw::packet(raw::connect, 0, fields.dump())));
    }

    hive::test::Process camera_ = prey.swarm().drone("camera", "cam", {"width=160", "height=120", "fps=10", "noise=0"});
    raw::Listener listener_{prey.swarm().home() / "liar.sock"};
    std::optional<raw::Peer> peer_;
    raw::Peer asker_ = prey.meet("asker");
    int id_ = 0;
};

}  // namespace hostile
