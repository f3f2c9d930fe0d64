// nng: pub0 and sub0, which lose frames by design, so the harness keeps a window; req0 and rep0. Frames are produced in
// the body of a message.
//
//     bench_nng tcp | ipc
#include "../harness/transport.hpp"

#include <nng/nng.h>
#include <nng/protocol/pubsub0/pub.h>
#include <nng/protocol/pubsub0/sub.h>
#include <nng/protocol/reqrep0/rep.h>
#include <nng/protocol/reqrep0/req.h>

#include <cstring>
#include <stdexcept>
#include <unistd.h>

namespace hive::bench {
namespace {

constexpr int receive_queue = 128, send_queue = 64;

std::string address_of(const Run& run)
{
    return run.is("ipc") ? "ipc:///tmp/" + run.place + ".nng" : "tcp://127.0.0.1:" + std::to_string(run.port);
}

void require(int code)
{
    if (code != 0)
        throw std::runtime_error(nng_strerror(code));
}

struct FreeMessage {
    void operator()(nng_msg* message) const { nng_msg_free(message); }
};
using Message = std::unique_ptr<nng_msg, FreeMessage>;

Message message_of_size(std::size_t size)
{
    nng_msg* message = nullptr;
    require(nng_msg_alloc(&message, size));
    return Message(message);
}

Message message_of(const Frame& frame)
{
    Message message = message_of_size(frame.image.size());
    frame.produce(static_cast<std::byte*>(nng_msg_body(message.get())));
    return message;
}

std::span<const std::byte> bytes_of(const Message& message)
{
    return {static_cast<const std::byte*>(nng_msg_body(message.get())), nng_msg_len(message.get())};
}

class NngSocket {
public:
    explicit NngSocket(int (*open)(nng_socket*))
    {
        require(open(&socket));
        nng_socket_set_size(socket, NNG_OPT_RECVMAXSZ, 0);  // no limit
        nng_socket_set_ms(socket, NNG_OPT_RECONNMINT, 5);
        nng_socket_set_ms(socket, NNG_OPT_RECONNMAXT, 5);
        nng_socket_set_bool(socket, NNG_OPT_TCP_NODELAY, true);
    }
    ~NngSocket() { nng_close(socket); }
    NngSocket(const NngSocket&) = delete;
    NngSocket& operator=(const NngSocket&) = delete;

    /// True when the library has taken it.
    bool send(Message message) const
    {
        const bool taken = nng_sendmsg(socket, message.get(), 0) == 0;
        if (taken)
            (void)message.release();
        return taken;
    }
    /// Empty when the socket is closed.
    [[nodiscard]] Message receive() const
    {
        nng_msg* message = nullptr;
        return Message(nng_recvmsg(socket, &message, 0) == 0 ? message : nullptr);
    }

    nng_socket socket{};
};

class NngPublisher : public PushPublisher {
public:
    explicit NngPublisher(const Run& run) : socket_(nng_pub0_open)
    {
        nng_socket_set_int(socket_.socket, NNG_OPT_SENDBUF, send_queue);
        require(nng_listen(socket_.socket, address_of(run).c_str(), nullptr, 0));
    }

private:
    void send(const Frame& frame) override { socket_.send(message_of(frame)); }
    NngSocket socket_;
};

class NngSubscriber : public Subscriber {
public:
    explicit NngSubscriber(const Run& run) : socket_(nng_sub0_open)
    {
        nng_socket_set_int(socket_.socket, NNG_OPT_RECVBUF, receive_queue);
        require(nng_socket_set(socket_.socket, NNG_OPT_SUB_SUBSCRIBE, "", 0));
        require(nng_dial(socket_.socket, address_of(run).c_str(), nullptr, NNG_FLAG_NONBLOCK));
    }
    void receive(const OnFrame& on_frame) override
    {
        for (auto message = socket_.receive(); message && on_frame(bytes_of(message));)
            message = socket_.receive();
    }

private:
    NngSocket socket_;
};

class NngServer : public Server {
public:
    explicit NngServer(const Run& run) : socket_(nng_rep0_open)
    {
        require(nng_listen(socket_.socket, address_of(run).c_str(), nullptr, 0));
    }
    void serve(const std::function<void()>& serving, const OnRequest& on_request) override
    {
        serving();
        Request request{};
        Frame answer{};
        for (bool more = true; more;) {
            const auto message = socket_.receive();
            if (!message || bytes_of(message).size() != sizeof request)
                return;
            std::memcpy(&request, bytes_of(message).data(), sizeof request);
            more = on_request(request, answer);
            socket_.send(message_of(answer));
        }
        sleep_for(50 * millisecond);  // the last answer leaves before the process ends
    }

private:
    NngSocket socket_;
};

class NngClient : public Client {
public:
    explicit NngClient(const Run& run) : socket_(nng_req0_open)
    {
        const auto end = now_ns() + 5 * second;
        while (nng_dial(socket_.socket, address_of(run).c_str(), nullptr, 0) != 0) {
            if (now_ns() > end)
                throw std::runtime_error("nobody answers");
            sleep_for(2 * millisecond);
        }
    }
    bool ask(const Request& request, const FrameCheck& check) override
    {
        Message message = message_of_size(sizeof request);
        std::memcpy(nng_msg_body(message.get()), &request, sizeof request);
        if (!socket_.send(std::move(message)))
            return false;
        const auto answer = socket_.receive();
        return answer && check.whole(bytes_of(answer));
    }

private:
    NngSocket socket_;
};

class Nng : public Transport {
public:
    std::unique_ptr<Publisher> publisher(const Run& run) const override { return std::make_unique<NngPublisher>(run); }
    std::unique_ptr<Subscriber> subscriber(const Run& run) const override
    {
        return std::make_unique<NngSubscriber>(run);
    }
    std::unique_ptr<Server> server(const Run& run) const override { return std::make_unique<NngServer>(run); }
    std::unique_ptr<Client> client(const Run& run) const override { return std::make_unique<NngClient>(run); }
    [[nodiscard]] int credit(const Run& run) const override
    {
        return run.test != Test::throughput ? 0 : run.size > 1'000'000 ? 8 : 64;
    }
    void clean(const Run& run) const override { ::unlink(("/tmp/" + run.place + ".nng").c_str()); }
};

}  // namespace
}  // namespace hive::bench

int main(int argc, char** argv) { return hive::bench::row_main("nng", hive::bench::Nng(), argc, argv); }
