// ZeroMQ by cppzmq: PUB and SUB, with XPUB_NODROP, so that a publisher waits at the high-water mark and nothing is
// lost; REQ and REP. Frames are produced in the storage of a message.
//
//     bench_zmq tcp | ipc
#include "../harness/transport.hpp"

#include <zmq.hpp>

#include <algorithm>
#include <unistd.h>

namespace hive::bench {
namespace {

std::string address_of(const Run& run)
{
    return run.is("ipc") ? "ipc:///tmp/" + run.place + ".zmq" : "tcp://127.0.0.1:" + std::to_string(run.port);
}

zmq::message_t message_of(const Frame& frame)
{
    zmq::message_t message(frame.image.size());
    frame.produce(message.data<std::byte>());
    return message;
}

std::span<const std::byte> bytes_of(const zmq::message_t& message)
{
    return {message.data<std::byte>(), message.size()};
}

/// A context and its one socket.
struct Place {
    Place(zmq::socket_type type) : socket(context, type)
    {
        socket.set(zmq::sockopt::linger, 0);
        socket.set(zmq::sockopt::reconnect_ivl, 5);
    }
    void high_water_mark(const Run& run)
    {
        const int frames = run.size > 1'000'000 ? 4 : 64;
        socket.set(zmq::sockopt::sndhwm, frames);
        socket.set(zmq::sockopt::rcvhwm, frames);
    }
    zmq::context_t context{1};
    zmq::socket_t socket;
};

class ZmqPublisher : public PushPublisher {
public:
    explicit ZmqPublisher(const Run& run) : place_(zmq::socket_type::pub)
    {
        place_.high_water_mark(run);
        place_.socket.set(zmq::sockopt::xpub_nodrop, true);
        place_.socket.bind(address_of(run));
    }

private:
    void send(const Frame& frame) override { place_.socket.send(message_of(frame), zmq::send_flags::none); }
    Place place_;
};

class ZmqSubscriber : public Subscriber {
public:
    explicit ZmqSubscriber(const Run& run) : place_(zmq::socket_type::sub)
    {
        place_.high_water_mark(run);
        place_.socket.set(zmq::sockopt::subscribe, "");
        place_.socket.connect(address_of(run));
    }
    void receive(const OnFrame& on_frame) override
    {
        zmq::message_t message;
        while (place_.socket.recv(message) && on_frame(bytes_of(message))) {
        }
    }

private:
    Place place_;
};

class ZmqServer : public Server {
public:
    explicit ZmqServer(const Run& run) : place_(zmq::socket_type::rep)
    {
        place_.socket.set(zmq::sockopt::linger, 500);  // the last answer leaves before the process ends
        place_.socket.bind(address_of(run));
    }
    void serve(const std::function<void()>& serving, const OnRequest& on_request) override
    {
        serving();
        zmq::message_t message;
        Request request{};
        Frame answer{};
        for (bool more = true; more && place_.socket.recv(message) && message.size() == sizeof request;) {
            std::copy_n(message.data<std::byte>(), sizeof request, reinterpret_cast<std::byte*>(&request));
            more = on_request(request, answer);
            place_.socket.send(message_of(answer), zmq::send_flags::none);
        }
    }

private:
    Place place_;
};

class ZmqClient : public Client {
public:
    explicit ZmqClient(const Run& run) : place_(zmq::socket_type::req) { place_.socket.connect(address_of(run)); }
    bool ask(const Request& request, const FrameCheck& check) override
    {
        zmq::message_t answer;
        place_.socket.send(zmq::buffer(&request, sizeof request), zmq::send_flags::none);
        return place_.socket.recv(answer) && check.whole(bytes_of(answer));
    }

private:
    Place place_;
};

class Zmq : public Transport {
public:
    std::unique_ptr<Publisher> publisher(const Run& run) const override { return std::make_unique<ZmqPublisher>(run); }
    std::unique_ptr<Subscriber> subscriber(const Run& run) const override
    {
        return std::make_unique<ZmqSubscriber>(run);
    }
    std::unique_ptr<Server> server(const Run& run) const override { return std::make_unique<ZmqServer>(run); }
    std::unique_ptr<Client> client(const Run& run) const override { return std::make_unique<ZmqClient>(run); }
    void clean(const Run& run) const override { ::unlink(("/tmp/" + run.place + ".zmq").c_str()); }
};

}  // namespace
}  // namespace hive::bench

int main(int argc, char** argv) { return hive::bench::row_main("zmq", hive::bench::Zmq(), argc, argv); }
