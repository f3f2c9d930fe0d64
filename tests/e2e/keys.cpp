// A swarm over TCP with a key: creates, copies, uses and rotates the key, and tries another one.
#include "swarm.hpp"

#include <hive/event/module.hpp>
#include <hive/protocol/requests.hpp>

#include <doctest/doctest.h>

#include <thread>
#include <sys/stat.h>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

namespace fs = std::filesystem;

/// Copies a file of the first machine to the second, as scp would.
void hand_over(const fs::path& file, const Swarm& to)
{
    fs::create_directories(to.key_file().parent_path());
    fs::copy_file(file, to.key_file(), fs::copy_options::overwrite_existing);
}

std::string tcp_address(const Swarm& swarm, const std::string& drone)
{
    const std::string text = swarm.log(drone), before = "listening on ";
    const auto begin = text.find(before + "tcp://");
    REQUIRE(begin != std::string::npos);
    return text.substr(begin + before.size(), text.find('\n', begin) - begin - before.size());
}

/// A module on another machine with an address and perhaps a key.
class Stranger {
public:
    explicit Stranger(const fs::path& key = {})
        : module_({.self = {.name = "stranger", .kind = "application", .epoch = 1, .pid = 1},
                   .limits = {},
                   .timing = {},
                   .keys = key.empty() ? nullptr : std::make_shared<hive::transport::KeyRing>(key)})
    {
        module_.start();
    }

    hive::event::Outcome ask(const std::string& address, hive::protocol::PacketType type,
                             const Json& header = Json::object())
    {
        std::optional<hive::event::Outcome> outcome;
        module_.call([&] {
            module_.request(hive::transport::parse_address(address), type, header, {},
                            hive::event::Clock::now() + patient(5000ms),
                            [&](const hive::event::Outcome& came) { outcome = came; });
        });
        module_.loop().wait(hive::event::Clock::time_point::max(), [&] { return outcome.has_value(); });
        return *outcome;
    }
    hive::Error refusal(const std::string& address,
                        hive::protocol::PacketType type = hive::protocol::PacketType::describe)
    {
        const auto outcome = ask(address, type);
        REQUIRE(std::holds_alternative<hive::Error>(outcome));
        return std::get<hive::Error>(outcome);
    }

private:
    hive::event::Module module_;
};

using hive::protocol::PacketType;

/// Makes a counter receive the ticker at an address.
Json connection_to(const std::string& address)
{
    return to_json(hive::protocol::Connect{
        .drone = "ticker", .output = "tick", .address = address, .input = "tick", .options = {}});
}

/// Has this receiver got an event recently?
std::int64_t received(const Swarm& swarm, const std::string& drone)
{
    std::int64_t sum = 0;
    for (const auto& input : swarm.application().status(drone).inputs)
        sum += input.received;
    return sum;
}

}  // namespace

TEST_CASE("keys: a drone does not listen on tcp without a key, and says the commands that help")
{
    const Swarm swarm;
    const auto refused = swarm.hivectl({"start", "ticker", "--listen", "tcp://127.0.0.1:0"});
    CHECK(refused.exit_code == 5);
    CHECK(has(refused.err, "hivectl key new"));
    CHECK(has(refused.err, "--insecure"));
    CHECK(swarm.hivectl_done({"key", "new"}) == swarm.key_file().string() + "\n");
    CHECK(swarm.hivectl({"start", "ticker", "--listen", "tcp://127.0.0.1:0"}).exit_code == 0);
    fs::permissions(swarm.key_file(), fs::perms(0644));
    const auto open = swarm.hivectl({"start", "ticker", "--as", "second", "--listen", "tcp://127.0.0.1:0"});
    CHECK(open.exit_code == 5);
    CHECK(has(open.err, "chmod 600"));
}

TEST_CASE("keys: two machines with one key share a swarm over tcp, and nobody else takes part")
{
    const Swarm here, there;
    here.hivectl_done({"key", "new"});
    hand_over(here.key_file(), there);
    const auto ticker = here.drone("ticker", "ticker", {"fps=50"}, {"--listen", "tcp://127.0.0.1:0"});
    const auto counter = there.drone("counter", "counter", {}, {"--listen", "tcp://127.0.0.1:0"});
    const auto source = tcp_address(here, "ticker"), sink = tcp_address(there, "counter");

    Stranger member(here.key_file());
    const auto connected = member.ask(sink, PacketType::connect, connection_to(source));
    if (const auto* error = std::get_if<hive::Error>(&connected))
        FAIL(error->what());
    CHECK(eventually([&] { return received(there, "counter") >= 10; }));

    Stranger keyless, other;
    CHECK(keyless.refusal(source).code() == hive::Errc::not_permitted);
    here.hivectl_done({"key", "new", "--file", (here.home() / "other.key").string()});
    Stranger wrong(here.home() / "other.key");
    const auto refusal = wrong.refusal(source);
    CHECK(refusal.code() == hive::Errc::not_permitted);
    CHECK(has(refusal.what(), "wrong swarm key"));
    // A refused peer may know that before the drone has logged it.
    CHECK(eventually([&] { return has(here.log("ticker"), "is not known here"); }));
    CHECK(eventually([&] { return has(here.log("ticker"), "uses no key"); }));

    here.hivectl_done({"key", "view"});
    Stranger viewer(here.key_file().parent_path() / "viewer.key");
    CHECK(std::holds_alternative<Json>(viewer.ask(source, PacketType::describe)));
    CHECK(std::holds_alternative<Json>(viewer.ask(source, PacketType::status)));
    const auto stop = viewer.refusal(source, PacketType::stop);
    CHECK(stop.code() == hive::Errc::not_permitted);
    CHECK(has(stop.what(), "a viewer may not send stop"));
    CHECK(here.application().status("ticker").pid == ticker.pid());
}

TEST_CASE("keys: when the key is changed, connections of the old one end, and come back with the new one")
{
    const Swarm here, there;
    here.hivectl_done({"key", "new"});
    hand_over(here.key_file(), there);
    const auto ticker = here.drone("ticker", "ticker", {"fps=50"}, {"--listen", "tcp://127.0.0.1:0"});
    const auto counter = there.drone("counter", "counter");
    Stranger local;
    const auto sink = "unix:" + (there.home() / "counter.sock").string();
    REQUIRE(
        std::holds_alternative<Json>(local.ask(sink, PacketType::connect, connection_to(tcp_address(here, "ticker")))));
    const auto connected = [&] { return there.application().status("counter").inputs.at(0).connected; };
    REQUIRE(eventually([&] { return connected() && received(there, "counter") > 0; }));
    const auto old = Json::parse(here.hivectl_done({"key", "show", "--json"})).at(0).at("id").get<std::string>();

    here.hivectl_done({"key", "rotate", "--keep", "0"});
    CHECK(eventually([&] {
        return has(here.log("ticker"), "the swarm key " + old + " has expired")
               || has(here.log("ticker"), old + " is not known here");
    }));
    CHECK(eventually([&] { return !connected(); }));
    hand_over(here.key_file(), there);
    const auto before = received(there, "counter");
    CHECK(eventually([&] { return connected() && received(there, "counter") > before; }));
}

TEST_CASE("keys: what concerns a drone's machine is set on that machine, and over tcp only if it was started so")
{
    const Swarm swarm;
    swarm.hivectl_done({"key", "new"});
    swarm.hivectl_done({"key", "view"});
    const auto camera = swarm.drone("camera", "camera", {"fps=10"}, {"--listen", "tcp://127.0.0.1:0"});
    const auto open = swarm.drone("camera", "open", {"fps=10"}, {"--listen", "tcp://127.0.0.1:0", "--remote-operator"});
    Stranger member(swarm.key_file()), viewer(swarm.key_file().parent_path() / "viewer.key");
    const auto closed = tcp_address(swarm, "camera");
    const auto set = [&](const std::string& address, const Json& parameters) {
        return member.ask(address, PacketType::set, to_json(hive::protocol::Set{.parameters = parameters}));
    };
    const auto refused = set(closed, {{"fps", 20}, {"source", "/etc/passwd"}});
    REQUIRE(std::holds_alternative<hive::Error>(refused));
    CHECK(std::get<hive::Error>(refused).code() == hive::Errc::not_permitted);
    CHECK(has(std::get<hive::Error>(refused).advice(), "--remote-operator"));
    CHECK(swarm.application().get("camera", {"fps"}) == Json{{"fps", 10.0}});
    CHECK(std::holds_alternative<Json>(set(closed, {{"fps", 20}})));
    CHECK(std::holds_alternative<Json>(set(tcp_address(swarm, "open"), {{"source", "scene"}})));
    CHECK(swarm.hivectl_done({"set", "camera", "source=scene"}) == "scene\n");

    const auto seen = viewer.ask(closed, PacketType::get);
    REQUIRE(std::holds_alternative<Json>(seen));
    CHECK(std::get<Json>(seen).at("parameters").contains("fps"));
    CHECK_FALSE(std::get<Json>(seen).at("parameters").contains("source"));
    CHECK(std::holds_alternative<hive::Error>(viewer.ask(closed, PacketType::get, {{"names", {"source"}}})));
    CHECK(std::holds_alternative<Json>(member.ask(closed, PacketType::get, {{"names", {"source"}}})));
}

TEST_CASE("keys: hivectl key makes, shows and changes keys, and never shows a secret")
{
    const Swarm swarm;
    const auto missing = swarm.hivectl({"key", "show"});
    CHECK(missing.exit_code == 3);
    CHECK(has(missing.err, "hivectl key new"));
    const auto made = Json::parse(swarm.hivectl_done({"key", "new", "--json"}));
    struct stat info {};
    REQUIRE(::stat(swarm.key_file().c_str(), &info) == 0);
    CHECK((info.st_mode & 0777) == 0600);
    const auto again = swarm.hivectl({"key", "new"});
    CHECK(again.exit_code == 1);
    CHECK(has(again.err, "hivectl key rotate"));
    swarm.hivectl_done({"key", "view"});
    CHECK(swarm.hivectl({"key", "view"}).exit_code == 1);
    swarm.hivectl_done({"key", "view", "--replace"});
    const auto viewer = (swarm.key_file().parent_path() / "viewer.key").string();
    CHECK(swarm.hivectl({"key", "rotate", "--file", viewer}).exit_code == 5);
    swarm.hivectl_done({"key", "rotate"});
    const auto shown = swarm.hivectl_done({"key", "show", "--json"});
    const auto keys = Json::parse(shown);
    REQUIRE(keys.size() == 2);
    CHECK(keys[1].at("id") == made.at("id"));
    CHECK(keys[1].at("holds_for_us").get<std::int64_t>() > 86'000'000'000);
    const auto file = Json::parse(text_of(swarm.key_file()));
    for (const auto& key : file.at("keys"))
        CHECK_FALSE(has(shown + swarm.hivectl_done({"key", "show"}), key.at("secret").get<std::string>()));
}

TEST_CASE("keys: several changes of the key at once lose none")
{
    const Swarm swarm;
    swarm.hivectl_done({"key", "new"});
    std::vector<std::thread> threads;
    for (int i = 0; i < 5; ++i)
        threads.emplace_back([&] { CHECK(swarm.hivectl({"key", "rotate"}).exit_code == 0); });
    for (auto& thread : threads)
        thread.join();
    CHECK(hive::read_key_file(swarm.key_file()).size() == 6);
}
