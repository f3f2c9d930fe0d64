// The TXT record and its proofs, and which address is announced and dialed.
#include <hive/discovery/announcement.hpp>

#include <doctest/doctest.h>

#include <algorithm>

namespace hive::discovery {
namespace {

const Service service{.host = "cam1", .port = 7700};

SwarmKey members_key() { return new_swarm_key(1'700'000'000); }

Announcement camera(const std::vector<SwarmKey>& keys)
{
    Announcement said{.drone = "camera", .kind = "scene", .epoch = 1'700'000'000'000'000};
    prove(said, service, keys);
    return said;
}

/// The record with one field changed, added, or (empty) left out.
std::vector<std::string> with(std::vector<std::string> txt, const std::string& key, const std::string& field)
{
    std::erase_if(txt, [&](const std::string& text) { return text.starts_with(key + "="); });
    if (!field.empty())
        txt.push_back(field);
    return txt;
}

Neighbour at(const std::string& host, const std::string& address, std::int64_t epoch = 1)
{
    const auto found = neighbour({.drone = "camera", .kind = "camera", .epoch = epoch}, {host, 7700}, address, false);
    REQUIRE(found);
    return *found;
}

}  // namespace

TEST_CASE("announcement: what is written is read again")
{
    auto said = camera({members_key(), members_key()});
    CHECK(from_txt(to_txt(said)) == said);
    said.at = "tcp://[2001:db8::7]:7701";
    CHECK(from_txt(to_txt(said)) == said);
    for (const auto& text : to_txt(camera(std::vector(9, members_key()))))
        CHECK_MESSAGE(text.size() <= 255, text);  // what a string of a TXT record can hold
}

TEST_CASE("announcement: what strangers write is refused unless it is whole and within bounds")
{
    const auto txt = to_txt(camera({members_key()}));
    const std::string digits(32, 'a');
    for (const std::string key : {"txtvers", "name", "kind", "epoch", "key", "proof", "members"}) {
        CHECK_MESSAGE(!from_txt(with(txt, key, "")), key);
        CHECK_MESSAGE(!from_txt(with(txt, key, key + "=")), key);
        CHECK_MESSAGE(!from_txt(with(txt, key, key + "=\x1b[2J")), key);
    }
    for (const std::string bad :
         {"txtvers=2", "name=../x", "name=a b", "kind=<b>", "epoch=0", "epoch=-1", "epoch=1x", "at=unix:/tmp/x",
          "epoch=99999999999999999999", "at=tcp://0.0.0.0:7700", "at=tcp://h:0", "at=tcp://a b:7700", "at=nonsense",
          "at=tcp://-oProxyCommand:7700", "at=tcp://x\n:7700"})
        CHECK_MESSAGE(!from_txt(with(txt, bad.substr(0, bad.find('=')), bad)), bad);
    CHECK_FALSE(from_txt(with(txt, "name", "name=" + std::string(65, 'x'))));
    CHECK_FALSE(from_txt(with(txt, "key", "key=" + digits + "," + digits)));  // of two keys, but one proof
    std::string five = digits;
    for (int i = 0; i < 4; ++i)
        five += "," + digits;
    CHECK_FALSE(
        from_txt(with(with(with(txt, "key", "key=" + five), "proof", "proof=" + five), "members", "members=" + five)));
    CHECK_FALSE(from_txt(std::vector<std::string>(17, "x=y")));
    CHECK_FALSE(from_txt({}));
    CHECK_FALSE(from_txt({"", "=", "name"}));
    CHECK(from_txt(with(txt, "unknown", "unknown=of a later version")));
}

TEST_CASE("announcement: who holds the key, as a member or as a viewer, knows it, and nobody else")
{
    const auto key = members_key(), former = members_key(), other = members_key();
    const auto said = camera({key, former});
    CHECK(is_proved(said, service, {key}));
    CHECK(is_proved(said, service, {former}));
    CHECK(is_proved(said, service, {viewers_key(key)}));
    CHECK(is_proved(said, service, {other, key}));
    CHECK_FALSE(is_proved(said, service, {other}));
    CHECK_FALSE(is_proved(said, service, {}));
    CHECK(is_proved(said, {"cam1.local", 7700}, {key}));
}

TEST_CASE("announcement: what was announced cannot be announced for another drone, machine, port or place")
{
    const auto key = members_key();
    const auto said = camera({key});
    CHECK_FALSE(is_proved(said, {"evil", 7700}, {key}));
    CHECK_FALSE(is_proved(said, {"cam1", 7701}, {key}));
    const auto changed = [&](auto change) {
        auto copy = said;
        change(copy);
        return is_proved(copy, service, {key});
    };
    CHECK(changed([](Announcement&) {}));
    CHECK_FALSE(changed([](Announcement& copy) { copy.drone = "door"; }));
    CHECK_FALSE(changed([](Announcement& copy) { copy.kind = "door"; }));
    CHECK_FALSE(changed([](Announcement& copy) { ++copy.epoch; }));
    CHECK_FALSE(changed([](Announcement& copy) { copy.at = "tcp://evil:7700"; }));
    CHECK_FALSE(changed([](Announcement& copy) { std::ranges::reverse(copy.proofs.at(0).members_proof); }));
}

TEST_CASE("announcement: what who has the viewers' key announces is known by viewers alone")
{
    const auto key = members_key(), viewers = viewers_key(key);
    const auto forged = camera({viewers});
    CHECK(is_proved(forged, service, {viewers}));
    CHECK_FALSE(is_proved(forged, service, {key}));
}

TEST_CASE("announcement: announced is what is advertised, or where others reach it")
{
    const auto spot = [](const std::vector<std::string>& listen, const std::vector<std::string>& advertise = {}) {
        const auto found = announced_spot(listen, advertise);
        return found ? std::to_string(found->port) + " " + found->at : "none";
    };
    CHECK(spot({"tcp://0.0.0.0:7700"}) == "7700 ");
    CHECK(spot({"tcp://[::]:7700"}) == "7700 ");
    CHECK(spot({"tcp://127.0.0.1:7700", "tcp://192.0.2.7:7701"}) == "7701 tcp://192.0.2.7:7701");
    CHECK(spot({"tcp://0.0.0.0:7700"}, {"tcp://cam1.example:8800"}) == "8800 tcp://cam1.example:8800");
    CHECK(spot({"tcp://127.0.0.1:7700"}) == "none");
    CHECK(spot({"tcp://[::1]:7700"}) == "none");
    CHECK(spot({"unix:/tmp/x.sock"}) == "none");
    CHECK(spot({}) == "none");
}

TEST_CASE("neighbour: it is called by its machine and dialed by number, or as it says")
{
    CHECK(at("cam1.local", "192.0.2.7").host == "cam1");
    CHECK(at("cam1.local", "192.0.2.7").address == "tcp://192.0.2.7:7700");
    CHECK(at("cam1.local", "2001:db8::7").address == "tcp://[2001:db8::7]:7700");
    CHECK(at("local", "192.0.2.7").host == "192.0.2.7");  // this machine is called so
    const auto elsewhere = neighbour({.drone = "c", .kind = "c", .epoch = 1, .at = "tcp://cam1.example:8800"}, service,
                                     "192.0.2.7", false);
    REQUIRE(elsewhere);
    CHECK(elsewhere->host == "cam1.example");
    CHECK(elsewhere->address == "tcp://cam1.example:8800");
    const Announcement said{.drone = "c", .kind = "c", .epoch = 1};
    CHECK_FALSE(neighbour(said, {"cam1", 0}, "192.0.2.7", false));
    CHECK_FALSE(neighbour(said, {"", 7700}, "192.0.2.7", false));
    CHECK_FALSE(neighbour(said, {"\x1b[2J", 7700}, "192.0.2.7", false));
    CHECK_FALSE(neighbour(said, {"cam1", 7700}, "0.0.0.0", false));
}

TEST_CASE("neighbour: several ways to one drone, and what it announced before, are one")
{
    const auto once = without_repetitions({at("cam1", "2001:db8::7"), at("cam1", "127.0.0.1"), at("cam1", "192.0.2.7"),
                                           at("gpu1", "192.0.2.8"), at("cam1", "192.0.2.9", 0)});
    REQUIRE(once.size() == 2);
    CHECK(once[0].address == "tcp://192.0.2.7:7700");
    CHECK(once[1].host == "gpu1");
}

}  // namespace hive::discovery
