// Hive as a row of the benchmark. Publisher, subscribers and server are drones in processes of their own; an
// application in the controller wires them.
//
//     bench_hive local     drones that meet on this machine; the image is copied into the loan
//     bench_hive local-zc  the same, but the camera has written into the loan: only header and tail are stamped
//     bench_hive tcp       over TCP on 127.0.0.1
//     bench_hive tls       the same, under a swarm key; dial=1: each RPC on a connection of its own
//
// lat: live events, streamed. thr: lossless events with a wide window, each produced when everybody has asked for it.
// sync: the same with window=1 (the default) or window=2. rpc: Application::get of one parameter.
#include "../harness/transport.hpp"
#include "bench_drones.hpp"
#include "caller.hpp"

#include <hive/application.hpp>
#include <hive/transport/key.hpp>

#include <cstdlib>
#include <filesystem>
#include <optional>

namespace hive::bench {
namespace {

namespace fs = std::filesystem;

fs::path home_of(const Run& run) { return fs::path("/tmp") / run.place; }
std::string local_address(const Run& run, const std::string& drone)
{
    return "unix:" + (home_of(run) / (drone + ".sock")).string();
}

ConnectionOptions options_of(const Run& run)
{
    ConnectionOptions options;
    const int wide = run.size > 1'000'000 ? 2 : 32;  // more of the large ones only push each other out of the cache
    options.transfer = run.test == Test::latency ? Transfer::streaming : Transfer::synchronized;
    options.window = run.window > 0 ? run.window : run.test == Test::throughput ? wide : 1;
    return options;
}

/// Tries again until the drones are there.
void within(Nanoseconds timeout, const std::function<void()>& attempt)
{
    for (const auto end = now_ns() + timeout;; sleep_for(2 * millisecond))
        try {
            return attempt();
        } catch (const Error&) {
            if (now_ns() > end)
                throw;
        }
}

void connect_local(const Run& run)
{
    Application application({.name = "bench", .home = home_of(run)});
    for (int i = 0; i < run.subscribers; ++i)
        within(10 * second, [&] {
            application.connect({source_name, frame_port}, {sink_name(i), frame_port}, options_of(run));
        });
}

/// As Application::connect, but the receiver is told an address: the application itself knows drones by name alone.
void connect_tcp(const Run& run)
{
    Caller caller;
    const Json from{{"drone", source_name}, {"output", frame_port}, {"address", tcp_address(run)}};
    const Json connect{{"from", from}, {"input", frame_port}, {"options", to_json(options_of(run))}};
    for (int i = 0; i < run.subscribers; ++i)
        within(10 * second,
               [&] { caller.ask(local_address(run, sink_name(i)), protocol::PacketType::connect, connect); });
}

class LocalClient : public Client {
public:
    bool ask(const Request& request, const FrameCheck&) override
    {
        const bool right = application_.get(source_name, {note_parameter}).value(note_parameter, "") == note_text;
        if (request.header.kind == Kind::end)
            application_.stop(source_name);
        return right;
    }

private:
    Application application_;
};

class TcpClient : public Client {
public:
    explicit TcpClient(const Run& run) : address_(tcp_address(run)), dials_(run.dial) {}

    bool ask(const Request& request, const FrameCheck&) override
    {
        if (dials_ || !caller_)
            caller_.emplace();
        const auto answer = caller_->ask(address_, protocol::PacketType::get, {{"names", {note_parameter}}});
        if (request.header.kind == Kind::end)
            caller_->ask(address_, protocol::PacketType::stop, Json::object());
        return answer.at("parameters").value(note_parameter, "") == note_text;
    }

private:
    std::string address_;
    bool dials_;
    std::optional<Caller> caller_;
};

class HiveRow : public Transport {
public:
    std::unique_ptr<Publisher> publisher(const Run& run) const override { return make_source(run); }
    std::unique_ptr<Subscriber> subscriber(const Run& run) const override { return make_sink(run); }
    std::unique_ptr<Server> server(const Run& run) const override { return make_answering_drone(run); }
    std::unique_ptr<Client> client(const Run& run) const override
    {
        if (over_tcp(run))
            return std::make_unique<TcpClient>(run);
        return std::make_unique<LocalClient>();
    }

    [[nodiscard]] bool answers(const Run& run) const override { return run.test == Test::rpc; }

    void prepare(Run& run) const override
    {
        fs::create_directory(home_of(run));
        fs::permissions(home_of(run), fs::perms::owner_all);
        ::setenv("HIVE_HOME", home_of(run).c_str(), 1);
        const auto key = home_of(run) / "swarm.key";
        ::setenv("HIVE_KEY", run.is("tls") ? key.c_str() : "none", 1);
        if (run.is("tls"))
            write_key_file(key, {new_swarm_key(0)}, KeyFileMode::fresh);
    }

    void wire(const Run& run) const override
    {
        if (!answers(run))
            over_tcp(run) ? connect_tcp(run) : connect_local(run);
    }

    void clean(const Run& run) const override { fs::remove_all(home_of(run)); }
};

}  // namespace
}  // namespace hive::bench

int main(int argc, char** argv) { return hive::bench::row_main("hive", hive::bench::HiveRow(), argc, argv); }
